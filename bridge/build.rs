//! Compiles `src/sumo/compiled.cpp` where it can be of use: on Linux with GNU's C library and C++ library, as libsumo's
//! wheels have them. Without it, or without a C++ compiler, the bridge asks libsumo's Python getters.

use std::env;

fn main() {
    let source = "src/sumo/compiled.cpp";
    println!("cargo:rerun-if-changed={source}");
    println!("cargo:rustc-check-cfg=cfg(compiled_getters)");
    let target = |what: &str| env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default();
    if target("OS") != "linux" || target("ENV") != "gnu" {
        return;
    }
    let mut build = cc::Build::new();
    match build.cpp(true).std("c++14").warnings_into_errors(true).file(source).try_compile("compiled_getters") {
        Ok(()) => println!("cargo:rustc-cfg=compiled_getters"),
        Err(error) => println!("cargo:warning=states are read through Python, which is slower: {error}"),
    }
}
