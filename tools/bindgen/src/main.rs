//! JavaScript for a module built with wasm-bindgen: `bindgen MODULE.wasm FOLDER`.
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args_os().skip(1);
    let (Some(module), Some(folder)) = (words.next(), words.next()) else {
        return Err("usage: bindgen MODULE.wasm FOLDER".into());
    };
    let mut bindgen = wasm_bindgen_cli_support::Bindgen::new();
    bindgen.input_path(module).web(true)?.typescript(false).remove_name_section(true);
    bindgen.generate(folder)?;
    Ok(())
}
