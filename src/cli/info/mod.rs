//! `meniscus info`: what this machine offers; `meniscus info FILE...`: what files hold, without a GPU.

mod file;
mod machine;
mod ron;

use super::args::InfoArgs;
use super::report::Exit;

pub fn run(args: &InfoArgs) -> Exit {
    if args.files.is_empty() { machine::run(args) } else { file::run(args) }
}
