//! Conversion between Rust data and NumPy arrays, without copies if the layout allows it.

use bytemuck::{Pod, allocation::cast_vec};
use glam::DVec3;
use numpy::{
    Element, IntoPyArray, PyArray, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    get_array_module,
    ndarray::{ArrayViewD, IxDyn},
};
use pyo3::{intern, prelude::*};

use crate::error::Failure;

/// Creates a read-only array that borrows `values`.
///
/// `owner` holds the values. They must neither change nor move while it is alive.
pub(crate) fn view<'py, T: Element + Pod>(
    owner: Bound<'py, PyAny>,
    values: &[T],
    shape: &[usize],
) -> Bound<'py, PyAny> {
    let view = ArrayViewD::from_shape(IxDyn(shape), values).expect("the shape matches the number of values");
    // SAFETY: the array keeps `owner` alive. All owners are frozen classes that hold their values in vectors.
    #[expect(unsafe_code, reason = "no safe function lets NumPy borrow memory that Rust owns")]
    let array = unsafe { PyArray::borrow_from_array(&view, owner) };
    let _ = array.readwrite().make_nonwriteable();
    array.into_any()
}

/// Moves points into an array of shape (N, 3) without copying.
pub(crate) fn points_to_array(py: Python<'_>, points: Vec<DVec3>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let count = points.len();
    let numbers: Vec<f64> = cast_vec(points);
    numbers.into_pyarray(py).reshape([count, 3])
}

/// Converts `array` to a C-contiguous array of `T`. Does not copy if it already is one.
pub(crate) fn contiguous<'py, T: Element>(array: &Bound<'py, PyAny>) -> Result<PyReadonlyArrayDyn<'py, T>, Failure> {
    let py = array.py();
    let numpy = get_array_module(py)?;
    let converted = numpy.call_method1(intern!(py, "ascontiguousarray"), (array, T::get_dtype(py)))?;
    let converted: Bound<'py, PyArrayDyn<T>> = converted.cast_into().map_err(PyErr::from)?;
    Ok(converted.try_readonly().map_err(PyErr::from)?)
}

/// Borrows the points of an array of shape (N, 3).
pub(crate) fn points<'a>(name: &str, array: &'a PyReadonlyArrayDyn<'_, f64>) -> Result<&'a [DVec3], Failure> {
    check_shape(name, array.shape(), &[None, Some(3)])?;
    Ok(bytemuck::cast_slice(numbers(name, array)?))
}

/// Borrows the numbers of an array in memory order.
pub(crate) fn numbers<'a, T: Element>(name: &str, array: &'a PyReadonlyArrayDyn<'_, T>) -> Result<&'a [T], Failure> {
    array.as_slice().map_err(|error| Failure::Argument(format!("{name}: {error}")))
}

/// Borrows the numbers of an array in memory order. All must be finite.
pub(crate) fn finite_numbers<'a, T: Element + Copy + Into<f64>>(
    name: &str,
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> Result<&'a [T], Failure> {
    let numbers = numbers(name, array)?;
    match array.py().detach(|| numbers.iter().position(|&number| !number.into().is_finite())) {
        Some(index) => Err(Failure::Argument(format!("{name}: the number at {index} is not finite"))),
        None => Ok(numbers),
    }
}

/// Converts an array of any integer type and shape to `i64`.
pub(crate) fn indices<'py>(name: &str, array: &Bound<'py, PyAny>) -> Result<PyReadonlyArrayDyn<'py, i64>, Failure> {
    let py = array.py();
    let integers = get_array_module(py)?.call_method1(intern!(py, "asarray"), (array,))?;
    let kind: String = integers.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
    // NumPy converts an empty list to an array of floats, which is acceptable.
    let is_empty = integers.getattr(intern!(py, "size"))?.eq(0)?;
    if kind != "i" && kind != "u" && !is_empty {
        let dtype = integers.getattr(intern!(py, "dtype"))?;
        return Err(Failure::Argument(format!("{name} must be integers, not {dtype}")));
    }
    contiguous::<i64>(&integers)
}

/// Converts a number to a vertex or joint index.
pub(crate) fn index(name: &str, number: i64) -> Result<u32, Failure> {
    u32::try_from(number).map_err(|_| Failure::Argument(format!("{name}: {number} is not a valid index")))
}

/// Converts an integer array of shape (N, 3) to vertex indices.
pub(crate) fn triangles(array: &Bound<'_, PyAny>) -> Result<Vec<[u32; 3]>, Failure> {
    let rows = indices("triangles", array)?;
    check_shape("triangles", rows.shape(), &[None, Some(3)])?;
    let index = |&number: &i64| u32::try_from(number);
    let (corners, _) = numbers("triangles", &rows)?.as_chunks::<3>();
    let read = |(triangle, corners): (usize, &[i64; 3])| {
        let [a, b, c] = corners.each_ref().map(index);
        match (a, b, c) {
            (Ok(a), Ok(b), Ok(c)) => Ok([a, b, c]),
            _ => Err(Failure::Argument(format!("triangle {triangle}: {corners:?} are not valid vertex indices"))),
        }
    };
    array.py().detach(|| corners.iter().enumerate().map(read).collect())
}

/// Rejects arrays of another shape. `None` allows any length of an axis.
pub(crate) fn check_shape(name: &str, shape: &[usize], expected: &[Option<usize>]) -> Result<(), Failure> {
    let fits = |(&length, expected): (&usize, &Option<usize>)| expected.is_none_or(|expected| length == expected);
    if shape.len() == expected.len() && shape.iter().zip(expected).all(fits) {
        return Ok(());
    }
    let expected: Vec<String> =
        expected.iter().map(|length| length.map_or("N".to_owned(), |n| n.to_string())).collect();
    Err(Failure::Argument(format!("{name} must have the shape ({}), not {shape:?}", expected.join(", "))))
}
