//! What a person asked for, from the interface to [`super::core::Core`].

use std::path::PathBuf;

use super::core::Recording;
use super::look::Look;
use crate::graph::value::Value;
use crate::scene::Camera;

#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A scene, particles; a graph, a mesh or an environment for what is open.
    Open(PathBuf),
    /// Takes away what was dropped onto the scene.
    TakeAway(PathBuf),
    /// Another value of a parameter; absent: the scene's, or the declared one.
    Set {
        path: String,
        value: Option<Value>,
    },
    /// All values as the files have them.
    ResetParams,
    /// Puts the changed values into the scene file, and what was dropped onto the scene.
    Save,
    /// Puts the camera into the scene file.
    SaveCamera,
    Camera(Camera),
    /// Keeps the camera as a viewpoint of this number.
    Keep(u8),
    /// Goes to a kept viewpoint.
    GoTo(u8),
    /// Looks at all of the content from where the camera stands.
    Frame,
    /// The scene's own camera.
    Home,
    /// All state as at the start.
    Restart,
    /// Points at a place in the picture, from -1 to 1 to the right and up.
    Point {
        at: [f64; 2],
        is_pressed: bool,
    },
    /// Reads everything again.
    Reload,
    Play(bool),
    /// After the last frame of a sequence comes the first.
    Repeat(bool),
    /// By frames, also back.
    Step(i64),
    /// To a time in seconds.
    Seek(f64),
    /// Seconds that pass in one second.
    Speed(f64),
    Switch {
        pass: String,
        on: bool,
    },
    /// Opens a place in an editor; line and column from 1.
    Edit {
        path: PathBuf,
        line: u32,
        column: u32,
    },
    /// Whether every pass runs in each frame, also those whose results are there.
    RunAll(bool),
    /// Whether the graph's statistics are looked at.
    Count(bool),
    Look(Option<Look>),
    /// Finds the first pass that writes NaN or infinity.
    Hunt,
    /// Writes the picture.
    Shoot(PathBuf),
    Record(Recording),
    StopRecording,
}
