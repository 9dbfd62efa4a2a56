//! The interface of the module in a browser.

use js_sys::Function;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Answers a task, both as JSON documents; `listener` is called with each event on the way, a JSON document too.
#[wasm_bindgen(js_name = answer)]
pub fn answer_to_page(task: &str, listener: &Function) -> String {
    crate::answer(task, &|event| {
        // A page that throws in its listener has its own report of it.
        let _ = listener.call1(&JsValue::NULL, &JsValue::from_str(event));
    })
}
