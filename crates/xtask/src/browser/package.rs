//! The JavaScript package: the compiled module, its bindings and its description.

use std::{fs, path::Path};

use serde_json::Value;
use wasm_bindgen_cli_support::Bindgen;
use wasmparser::{Parser, Payload};

use crate::{
    cross,
    shell::{TaskResult, workspace},
};

const TARGET: &str = "wasm32-unknown-unknown";

/// Largest size of the module in bytes. A larger limit lets a dependency double it unnoticed; a smaller one leaves no margin.
const MOST_BYTES: usize = 6_000_000;

/// The first byte of all 128-bit SIMD instructions (WebAssembly Core Specification 2.0, section 5.4.8).
const VECTOR_PREFIX: u8 = 0xfd;

/// Builds the package in a folder. Fails if the module is too large or uses no SIMD.
pub(crate) fn build_in(folder: &Path) -> TaskResult {
    fs::create_dir_all(folder)?;
    let built = cross::build("isochore-wasm", TARGET, ("RUSTFLAGS", "-Ctarget-feature=+simd128"))?;
    Bindgen::new()
        .input_path(built.join("isochore_wasm.wasm"))
        .out_name("isochore")
        .web(true)?
        .typescript(true)
        .omit_default_module_path(false)
        .generate(folder)?;
    let source = workspace().join("crates/wasm");
    let mut description: Value = serde_json::from_slice(&fs::read(source.join("package.json"))?)?;
    description["version"] = env!("CARGO_PKG_VERSION").into();
    fs::copy(source.join("README.md"), folder.join("README.md"))?;
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        fs::copy(workspace().join(name), folder.join(name))?;
    }
    fs::write(folder.join("package.json"), serde_json::to_string_pretty(&description)?)?;

    let module = fs::read(folder.join("isochore_bg.wasm"))?;
    let vectors = vector_instructions(&module)?;
    eprintln!("the package is in {}", folder.display());
    eprintln!("the module has {} bytes and {vectors} instructions of 128-bit SIMD", module.len());
    if module.len() > MOST_BYTES {
        return Err(format!("the limit is {MOST_BYTES} bytes").into());
    }
    if vectors == 0 {
        return Err("it has no SIMD instructions; was it compiled without the feature simd128?".into());
    }
    Ok(())
}

/// Number of 128-bit SIMD instructions in the module's functions.
fn vector_instructions(module: &[u8]) -> TaskResult<usize> {
    let mut count = 0;
    for payload in Parser::new(0).parse_all(module) {
        let Payload::CodeSectionEntry(function) = payload? else { continue };
        for instruction in function.get_operators_reader()?.into_iter_with_offsets() {
            let (_, offset) = instruction?;
            count += usize::from(module[offset] == VECTOR_PREFIX);
        }
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A module of one function, whose body is `code`: the other sections declare that it has no parameters and no results.
    fn module(code: &[u8]) -> Vec<u8> {
        let header = [0, b'a', b's', b'm', 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 3, 2, 1, 0];
        let size = code.len() as u8 + 2;
        [&header[..], &[10, size + 2, 1, size, 0], code, &[0x0b]].concat()
    }

    #[test]
    fn simd_instructions_are_distinguished_from_constants_with_the_same_byte() {
        // i32.const −3, which is written with the same byte, and drop.
        let constant = [0x41, 0xfd, 0x7f, 0x1a];
        assert_eq!(vector_instructions(&module(&constant)).unwrap(), 0);
        // v128.const, i32x4.neg, drop.
        let vectors = [&[0xfd, 12][..], &[0xfd; 16], &[0xfd, 0xa1, 1], &[0x1a]].concat();
        assert_eq!(vector_instructions(&module(&vectors)).unwrap(), 2);
        assert!(vector_instructions(&module(&[0xfd])).is_err());
    }
}
