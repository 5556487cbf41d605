use std::process::ExitCode;

fn main() -> ExitCode {
    meniscus::cli::run(std::env::args_os())
}
