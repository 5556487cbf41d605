//! What the plan of `graphs/iwasaki2006.ron` promises: what a camera does not touch, and the memory of four slices.

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::DiskFiles;
use meniscus::graph::value::Value;
use meniscus::plan::model::{InputInfo, Object, ObjectKind, Plan};
use meniscus::plan::{self, instantiate_stand_in};
use meniscus::{check, program};

use crate::golden;

fn planned(params: &[(&str, Value)], height: f64) -> Plan {
    let mut sources = Sources::new();
    let path = golden::root().join("graphs/iwasaki2006.ron");
    let program = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None).program.unwrap();
    let mut request = check::stand_in(&program);
    request.params = params.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    let particles = InputInfo::Particles {
        count: 210_000,
        radius: 0.005,
        min: [0.0; 3],
        max: [1.0, height, 1.0],
        attributes: vec![("position".into(), 3)],
    };
    request.inputs.insert("particles".into(), particles);
    instantiate_stand_in(&program, &request)
        .unwrap_or_else(|found| panic!("{}", render_all(&found, &sources, Style::Plain)))
}

/// Moving the camera alone rebuilds neither density, surfels nor caustics.
#[test]
fn a_camera_changes_no_density_and_no_caustics() {
    for holding in ["atlas", "four_slices"] {
        let plan = planned(&[("water.holding", Value::Word(holding.into()))], 0.5);
        let with_camera = |pass: &&plan::model::Pass| {
            let causes = &plan.units[pass.unit].causes;
            causes.viewport || causes.live.iter().any(|name| name.starts_with("camera."))
        };
        let of_water = |pass: &&plan::model::Pass| {
            ["water", "above", "light", "sky"]
                .iter()
                .any(|part| pass.path.strip_prefix(part).is_some_and(|rest| rest.starts_with(['/', '.'])))
        };
        let (touched, kept): (Vec<_>, Vec<_>) = plan.passes.iter().partition(with_camera);
        assert!(!touched.iter().any(of_water), "{:?}", touched.iter().find(|p| of_water(p)).map(|p| &p.path));
        assert!(kept.iter().filter(|p| of_water(p)).count() > 40, "the parts are there");
        assert!(touched.iter().any(|pass| pass.path == "shade"), "what is seen follows the camera");
    }
}

/// Bytes of what holds densities, by the plan's own figures.
fn densities(plan: &Plan, height: f64) -> u64 {
    let holds = |object: &&Object| {
        let names = ["water.atlas", "water.ring"];
        names.contains(&object.path.as_str()) && object.lifetime.is_some()
    };
    let all: Vec<&Object> = plan.objects.iter().filter(holds).collect();
    assert!(!all.is_empty(), "nothing holds densities at {height} m");
    assert!(all.iter().all(|object| matches!(object.kind, ObjectKind::Texture(_))));
    all.iter().map(|object| plan::memory::bytes(&object.kind)).sum()
}

#[test]
fn four_slices_take_no_more_than_four_megabytes() {
    let grid = ("water.grid", Value::Int(256));
    for height in [0.05, 0.5, 1.0] {
        let plan = planned(&[grid.clone(), ("water.holding", Value::Word("four_slices".into()))], height);
        let bytes = densities(&plan, height);
        assert!(bytes <= 4_000_000, "{bytes} bytes at {height} m");
        assert!(bytes > 1_000_000, "{bytes} bytes at {height} m are too few to be true");
    }
    let atlas = densities(&planned(&[grid], 1.0), 1.0);
    assert!(atlas > 60_000_000, "the atlas holds them all: {atlas}");
}
