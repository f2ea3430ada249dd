//! The package for browsers: the module compiled, what binds it to JavaScript, and what describes both.

use std::{fs, path::Path};

use serde_json::json;
use wasm_bindgen_cli_support::Bindgen;
use wasmparser::{Parser, Payload};

use crate::{cross, shell::TaskResult};

const TARGET: &str = "wasm32-unknown-unknown";

/// Bytes that the module may have. Larger, and a dependency that doubles it goes unnoticed; smaller leaves no room to grow.
const MOST_BYTES: usize = 6_000_000;

/// The byte that all instructions on vectors of 128 bits begin with (WebAssembly Core Specification 2.0, section 5.4.8).
const VECTOR_PREFIX: u8 = 0xfd;

/// Builds the package in a folder, and fails where the module is too large or works on no vectors.
pub(super) fn build_in(folder: &Path) -> TaskResult {
    fs::create_dir_all(folder)?;
    let built = cross::build("isochore-wasm", TARGET, ("RUSTFLAGS", "-Ctarget-feature=+simd128"))?;
    Bindgen::new()
        .input_path(built.join("isochore_wasm.wasm"))
        .out_name("isochore")
        .web(true)?
        .typescript(true)
        .omit_default_module_path(false)
        .generate(folder)?;
    let description = json!({
        "name": "isochore",
        "version": env!("CARGO_PKG_VERSION"),
        "description": env!("CARGO_PKG_DESCRIPTION"),
        "license": env!("CARGO_PKG_LICENSE"),
        "type": "module",
        "main": "isochore.js",
        "types": "isochore.d.ts",
        "files": ["isochore.js", "isochore.d.ts", "isochore_bg.wasm", "isochore_bg.wasm.d.ts"],
    });
    fs::write(folder.join("package.json"), serde_json::to_string_pretty(&description)?)?;

    let module = fs::read(folder.join("isochore_bg.wasm"))?;
    let vectors = vector_instructions(&module)?;
    eprintln!("the package is in {}", folder.display());
    eprintln!("the module has {} bytes and {vectors} instructions on vectors of 128 bits", module.len());
    if module.len() > MOST_BYTES {
        return Err(format!("that is more than {MOST_BYTES} bytes").into());
    }
    if vectors == 0 {
        return Err("it works on no vectors: was it compiled without the feature simd128?".into());
    }
    Ok(())
}

/// How many instructions of the module's functions work on vectors of 128 bits.
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

    /// A module of one function, whose body is `code`: the other sections say that it takes and gives nothing.
    fn module(code: &[u8]) -> Vec<u8> {
        let header = [0, b'a', b's', b'm', 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 3, 2, 1, 0];
        let size = code.len() as u8 + 2;
        [&header[..], &[10, size + 2, 1, size, 0], code, &[0x0b]].concat()
    }

    #[test]
    fn instructions_on_vectors_are_told_from_numbers_that_look_like_them() {
        // i32.const −3, which is written with the same byte, and drop.
        let constant = [0x41, 0xfd, 0x7f, 0x1a];
        assert_eq!(vector_instructions(&module(&constant)).unwrap(), 0);
        // v128.const, i32x4.neg, drop.
        let vectors = [&[0xfd, 12][..], &[0xfd; 16], &[0xfd, 0xa1, 1], &[0x1a]].concat();
        assert_eq!(vector_instructions(&module(&vectors)).unwrap(), 2);
        assert!(vector_instructions(&module(&[0xfd])).is_err());
    }
}
