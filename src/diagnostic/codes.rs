//! The stable ids of diagnostics. What each means at length is a section of
//! `docs/diagnostics.md`; `explain` prints it, and a test holds the two lists equal.

/// The id of a kind of diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(pub(super) &'static str);

impl Code {
    pub fn as_str(self) -> &'static str {
        self.0
    }
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])* $name:ident = $id:literal;)*) => {
        impl Code {
            $($(#[doc = $doc])* pub const $name: Code = Code($id);)*
            /// Every id, in the order of `docs/diagnostics.md`.
            pub const ALL: &'static [Code] = &[$(Code::$name),*];
        }
    };
}

codes! {
    // Files
    /// A file that is named is not there.
    FILE_MISSING = "file-missing";
    /// A file is there but cannot be read.
    FILE_UNREADABLE = "file-unreadable";

    // Form (RON)
    /// The text is not RON.
    SYNTAX = "syntax";
    /// A field that the thing does not have.
    UNKNOWN_FIELD = "unknown-field";
    /// A field that must be given.
    MISSING_FIELD = "missing-field";
    /// A value of the wrong kind.
    WRONG_VALUE = "wrong-value";
    /// A word that is none of the choices.
    UNKNOWN_VARIANT = "unknown-variant";
    /// A name or field said twice.
    DUPLICATE = "duplicate";
    /// A name that WGSL could not spell.
    BAD_NAME = "bad-name";

    // Expressions
    /// An expression that cannot be parsed.
    EXPRESSION_SYNTAX = "expression-syntax";
    /// An expression whose operands do not fit.
    EXPRESSION_TYPE = "expression-type";
    /// A value that must be whole may be fractional.
    FRACTIONAL = "fractional";
    /// Something that is known only while a frame runs decides the plan.
    NOT_KNOWN_WHEN_PLANNING = "not-known-when-planning";
    /// Definitions that need each other.
    CYCLE = "cycle";

    // Names
    /// A name that nothing bears.
    UNKNOWN_NAME = "unknown-name";
    /// A name of the wrong kind of thing.
    WRONG_KIND = "wrong-kind";
    /// Two names that are one in WGSL.
    NAME_CLASH = "name-clash";
    /// A part includes itself.
    INCLUDE_CYCLE = "include-cycle";
    /// A given value does not fit the declaration.
    BAD_PARAMETER = "bad-parameter";
    /// An input that nothing feeds.
    MISSING_INPUT = "missing-input";
    /// An optional input used where it may be absent.
    OPTIONAL_INPUT = "optional-input";
    /// Something declared that nothing uses.
    UNUSED = "unused";

    // Shaders
    /// WGSL that naga does not accept.
    SHADER = "shader";
    /// An import that cannot be resolved.
    IMPORT = "import";
    /// No entry point, or more than one, for a stage.
    ENTRY_POINT = "entry-point";
    /// A shader's variable that nothing of the graph feeds.
    UNBOUND = "unbound";
    /// A `bind` entry that the shader does not have.
    UNKNOWN_BINDING = "unknown-binding";
    /// A resource of another kind than the shader's variable.
    BINDING_MISMATCH = "binding-mismatch";
    /// A uniform member or override of another type than what feeds it.
    UNIFORM_MISMATCH = "uniform-mismatch";
    /// Two shaders disagree about what a buffer holds.
    LAYOUT_DISAGREEMENT = "layout-disagreement";
    /// A shader that may be folded into rows does not use the linear index.
    FOLDED_DISPATCH = "folded-dispatch";

    // Targets and draws
    /// Fragment outputs and targets that do not match.
    TARGET_MISMATCH = "target-mismatch";
    /// A format that cannot do what is asked of it.
    FORMAT = "format";
    /// A field of a pass that makes no sense there.
    BAD_PASS = "bad-pass";

    // Resources
    /// A size, count or index outside what is possible.
    OUT_OF_RANGE = "out-of-range";
    /// Something reads what nothing wrote.
    NEVER_WRITTEN = "never-written";
    /// A resource that nothing reads.
    NEVER_READ = "never-read";
    /// A pass reads and writes one subresource.
    READ_WRITE_CONFLICT = "read-write-conflict";
    /// A swap of resources that are not alike.
    UNLIKE_SWAP = "unlike-swap";
    /// State used against its rules.
    STATE = "state";
    /// A counted buffer used against its rules.
    COUNTED = "counted";
    /// A pass that no output needs.
    CULLED = "culled";

    // Limits
    /// More than WebGPU's default limits or features.
    NEEDS = "needs";
    /// More than the device can do.
    DEVICE_LIMIT = "device-limit";
    /// More memory than a budget allows.
    MEMORY_BUDGET = "memory-budget";

    // Scenes and assets
    /// A particle, image or mesh file that cannot be taken.
    ASSET = "asset";
    /// Something about an asset that a person should know.
    ASSET_NOTE = "asset-note";

    // Running
    /// Arguments that ask for something impossible.
    USAGE = "usage";
    /// A counted buffer had too little room.
    OVERFLOW = "overflow";
    /// Nothing came to a counted buffer whose graph warns of that.
    EMPTY = "empty";
    /// The device refused or was lost.
    DEVICE = "device";
    /// A file that could not be written.
    OUTPUT = "output";
    /// What a declared case expects did not come out.
    TEST_FAILED = "test-failed";
}

const DOCS: &str = include_str!("../../docs/diagnostics.md");

/// The section of `docs/diagnostics.md` about an id, without its heading.
pub fn explain(id: &str) -> Option<&'static str> {
    let heading = format!("\n### {id}\n");
    let start = DOCS.find(&heading)? + heading.len();
    let rest = &DOCS[start..];
    let end = ["\n### ", "\n## "].iter().filter_map(|next| rest.find(next)).min().unwrap_or(rest.len());
    Some(rest[..end].trim())
}

/// The ids that `docs/diagnostics.md` has sections for.
pub fn explained() -> impl Iterator<Item = &'static str> {
    DOCS.lines().filter_map(|line| line.strip_prefix("### "))
}
