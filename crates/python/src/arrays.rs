//! NumPy arrays in and out: views where the layout allows, conversions where it does not.

use bytemuck::{Pod, allocation::cast_vec};
use glam::DVec3;
use numpy::{
    Element, IntoPyArray, PyArray, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    get_array_module,
    ndarray::{ArrayViewD, IxDyn},
};
use pyo3::{intern, prelude::*};

use crate::error::Failure;

/// A read-only view of `values`, which belong to `owner` and neither change nor move while it lives.
pub(crate) fn view<'py, T: Element + Pod>(
    owner: Bound<'py, PyAny>,
    values: &[T],
    shape: &[usize],
) -> Bound<'py, PyAny> {
    let view = ArrayViewD::from_shape(IxDyn(shape), values).expect("the shape has as many places as there are values");
    // SAFETY: the array keeps `owner` alive, and all owners are frozen classes that hold their values in vectors.
    #[expect(unsafe_code, reason = "NumPy has no other way to borrow memory that Rust owns")]
    let array = unsafe { PyArray::borrow_from_array(&view, owner) };
    let _ = array.readwrite().make_nonwriteable();
    array.into_any()
}

/// An array of points, shape (N, 3), that takes over their memory.
pub(crate) fn points_to_array(py: Python<'_>, points: Vec<DVec3>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let count = points.len();
    let numbers: Vec<f64> = cast_vec(points);
    numbers.into_pyarray(py).reshape([count, 3])
}

/// What NumPy makes of `array`: C-contiguous, of the type T; the array itself where it is that already.
pub(crate) fn contiguous<'py, T: Element>(array: &Bound<'py, PyAny>) -> Result<PyReadonlyArrayDyn<'py, T>, Failure> {
    let py = array.py();
    let numpy = get_array_module(py)?;
    let made = numpy.call_method1(intern!(py, "ascontiguousarray"), (array, T::get_dtype(py)))?;
    let made: Bound<'py, PyArrayDyn<T>> = made.cast_into().map_err(PyErr::from)?;
    Ok(made.try_readonly().map_err(PyErr::from)?)
}

/// The points in an array of numbers with shape (N, 3), without a copy.
pub(crate) fn points<'a>(name: &str, array: &'a PyReadonlyArrayDyn<'_, f64>) -> Result<&'a [DVec3], Failure> {
    check_shape(name, array.shape(), &[None, Some(3)])?;
    Ok(bytemuck::cast_slice(numbers(name, array)?))
}

/// The numbers in an array, in its order.
pub(crate) fn numbers<'a, T: Element>(name: &str, array: &'a PyReadonlyArrayDyn<'_, T>) -> Result<&'a [T], Failure> {
    array.as_slice().map_err(|error| Failure::Argument(format!("{name}: {error}")))
}

/// The same, which must all be finite.
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

/// Indices from an array of any integers, in any shape.
pub(crate) fn indices<'py>(name: &str, array: &Bound<'py, PyAny>) -> Result<PyReadonlyArrayDyn<'py, i64>, Failure> {
    let py = array.py();
    let made = get_array_module(py)?.call_method1(intern!(py, "asarray"), (array,))?;
    let kind: String = made.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
    // An empty list has no integers in it, but nothing else either.
    let is_empty = made.getattr(intern!(py, "size"))?.eq(0)?;
    if kind != "i" && kind != "u" && !is_empty {
        let dtype = made.getattr(intern!(py, "dtype"))?;
        return Err(Failure::Argument(format!("{name} must be integers, not {dtype}")));
    }
    contiguous::<i64>(&made)
}

/// The index that a number must be.
pub(crate) fn index(name: &str, number: i64) -> Result<u32, Failure> {
    u32::try_from(number).map_err(|_| Failure::Argument(format!("{name}: {number} is no index")))
}

/// Vertex indices of shape (N, 3) from an array of any integers.
pub(crate) fn triangles(array: &Bound<'_, PyAny>) -> Result<Vec<[u32; 3]>, Failure> {
    let made = indices("triangles", array)?;
    check_shape("triangles", made.shape(), &[None, Some(3)])?;
    let index = |&number: &i64| u32::try_from(number);
    let (corners, _) = numbers("triangles", &made)?.as_chunks::<3>();
    let read = |(triangle, corners): (usize, &[i64; 3])| {
        let [a, b, c] = corners.each_ref().map(index);
        match (a, b, c) {
            (Ok(a), Ok(b), Ok(c)) => Ok([a, b, c]),
            _ => Err(Failure::Argument(format!("triangle {triangle} has the vertices {corners:?}: no such index"))),
        }
    };
    array.py().detach(|| corners.iter().enumerate().map(read).collect())
}

/// Refuses arrays of another shape; None stands for any length.
pub(crate) fn check_shape(name: &str, shape: &[usize], wanted: &[Option<usize>]) -> Result<(), Failure> {
    let fits = |(&length, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|wanted| length == wanted);
    if shape.len() == wanted.len() && shape.iter().zip(wanted).all(fits) {
        return Ok(());
    }
    let wanted: Vec<String> = wanted.iter().map(|length| length.map_or("N".to_owned(), |n| n.to_string())).collect();
    Err(Failure::Argument(format!("{name} must have the shape ({}), not {shape:?}", wanted.join(", "))))
}
