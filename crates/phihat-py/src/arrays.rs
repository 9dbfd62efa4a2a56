//! NumPy arrays, checked on the way in: type, shape, finite numbers.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::failure::{argument, internal};

/// One number per joint, as in a control loop: an array of the right type, nothing else; `put` gets each
/// number with its joint. Nothing is allocated, and any stride will do.
pub(crate) fn per_joint(
    field: &str,
    value: &Bound<'_, PyAny>,
    joints: usize,
    mut put: impl FnMut(usize, f64),
) -> PyResult<()> {
    let Ok(array) = value.cast::<PyArray1<f64>>() else {
        return Err(not_an_array(field, value, "1"));
    };
    if array.len() != joints {
        return Err(wrong_shape(value.py(), field, array.shape(), &format!("({joints},)")));
    }
    for i in 0..joints {
        put(i, array.get_owned(i).unwrap_or(f64::NAN));
    }
    Ok(())
}

/// Numbers per joint with any axes before the last, or a plain sequence of numbers.
pub(crate) struct Batch {
    pub(crate) values: Vec<f64>,
    /// The axes before the last.
    pub(crate) axes: Vec<usize>,
    joints: usize,
}

impl Batch {
    /// Reads and checks an argument whose last axis is `names`.
    pub(crate) fn read(field: &str, value: &Bound<'_, PyAny>, names: &[String]) -> PyResult<Self> {
        let (py, n) = (value.py(), names.len());
        let (values, shape) = if let Ok(array) = value.cast::<PyArrayDyn<f64>>() {
            let in_order = array.is_c_contiguous();
            let ordered = if in_order { array.clone() } else { ordered(array)? };
            let values = ordered.to_vec().map_err(|e| internal(py, e))?;
            (values, array.shape().to_vec())
        } else if value.is_instance_of::<PyUntypedArray>() {
            return Err(not_an_array(field, value, "1 or more"));
        } else {
            let Ok(list) = value.extract::<Vec<f64>>() else {
                return Err(not_an_array(field, value, "1 or more"));
            };
            let shape = vec![list.len()];
            (list, shape)
        };
        let Some((last, axes)) = shape.split_last().filter(|(last, _)| **last == n) else {
            return Err(wrong_shape(py, field, &shape, &format!("(..., {n})")));
        };
        if let Some(at) = values.iter().position(|x| !x.is_finite()) {
            let (joint, x) = (&names[at % last], values[at]);
            let message = format!("{field}: {x} at joint {joint}; it must be a finite number");
            return Err(argument(py, field, Some(joint), x, "finite", &message));
        }
        Ok(Self { values, axes: axes.to_vec(), joints: n })
    }

    /// The values at place `k` of a batch; one posture serves for all.
    pub(crate) fn at(&self, k: usize) -> &[f64] {
        let k = if self.axes.is_empty() { 0 } else { k };
        &self.values[k * self.joints..(k + 1) * self.joints]
    }
}

/// The axes that arguments have in common: those of all that are not a single posture.
pub(crate) fn common_axes(
    py: Python<'_>,
    arguments: &[(&str, &Batch)],
) -> PyResult<(Vec<usize>, usize)> {
    let mut axes: &[usize] = &[];
    for (field, batch) in arguments {
        if batch.axes.is_empty() {
            continue;
        }
        if axes.is_empty() {
            axes = &batch.axes;
        } else if axes != batch.axes {
            let expected = format!("({axes:?}, {})", batch.joints).replace(['[', ']'], "");
            let shape: Vec<usize> = batch.axes.iter().copied().chain([batch.joints]).collect();
            return Err(wrong_shape(py, field, &shape, &expected));
        }
    }
    Ok((axes.to_vec(), axes.iter().product()))
}

/// An array of this shape from its values in C order.
pub(crate) fn shaped<'py>(
    py: Python<'py>,
    values: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    PyArray1::from_vec(py, values).reshape(shape.to_vec())
}

fn not_an_array(field: &str, value: &Bound<'_, PyAny>, axes: &str) -> PyErr {
    let py = value.py();
    let kind = value.getattr("dtype").map_or_else(
        |_| value.get_type().name().map_or_else(|_| "?".to_owned(), |n| n.to_string()),
        |dtype| {
            let axes = value.getattr("ndim").map_or_else(|_| String::new(), |n| n.to_string());
            format!("array of {dtype} with {axes} axes")
        },
    );
    let limit = format!("NumPy array of float64 with {axes} axis");
    let message = format!("{field}: {kind}; it must be a {limit}");
    argument(py, field, None, kind, &limit, &message)
}

fn wrong_shape(py: Python<'_>, field: &str, shape: &[usize], expected: &str) -> PyErr {
    let message = format!("{field}: shape {shape:?}; it must be {expected}");
    argument(py, field, None, shape.to_vec(), expected, &message)
}

/// The numbers of an array in C order.
fn ordered<'py>(array: &Bound<'py, PyArrayDyn<f64>>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let copy = array.py().import("numpy")?.call_method1("ascontiguousarray", (array,))?;
    Ok(copy.cast_into()?)
}
