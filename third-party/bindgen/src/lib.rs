//! Nothing, in place of bindgen.
//!
//! The crates `iceoryx2-pal-posix` and `iceoryx2-pal-os-api` name bindgen as a build dependency on every system and call
//! it on QNX alone, where this ends the build. Everywhere else it would only be compiled: with it libclang's bindings,
//! regular expressions and fifteen other crates, a tenth of what a build of the chain compiles.

#[cfg(target_os = "nto")]
compile_error!("on QNX iceoryx2 needs bindgen: remove its entry from [patch.crates-io] in Cargo.toml");
