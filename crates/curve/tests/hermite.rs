//! Table 1 of Mäurer and Jüttler 1999 on seeded random data and on short arcs, with the correct
//! signed λ₁ and λ₂ and with the printed absolute values.
#![allow(clippy::excessive_precision, reason = "golden values keep all computed digits")]

use glam::DVec3;
use isochore_curve::{Bezier, Curve, PhCubic, PhCubicError, RationalRotation};

/// End points and unit tangents.
#[derive(Debug, Clone, Copy)]
struct Data {
    chord: DVec3,
    t0: DVec3,
    t1: DVec3,
}

/// The quantities of table 1 in the printed form, which cancels on short arcs.
#[derive(Debug, Clone, Copy)]
struct Table {
    cosine: f64,
    lambda: [f64; 2],
    squared_gap: f64,
}

impl Data {
    fn new(start: DVec3, end: DVec3, start_tangent: DVec3, end_tangent: DVec3) -> Self {
        Self { chord: end - start, t0: start_tangent.normalize(), t1: end_tangent.normalize() }
    }

    fn table(&self) -> Table {
        let cosine = self.t0.dot(self.t1);
        let (along_start, along_end) = (self.chord.dot(self.t0), self.chord.dot(self.t1));
        let squared_sine = 1.0 - cosine * cosine;
        // The component of the chord in the plane of the tangents is λ₁ t₀ − λ₂ t₁.
        let lambda =
            [(along_start - cosine * along_end) / squared_sine, -(along_end - cosine * along_start) / squared_sine];
        let gap = self.chord.dot(self.t0.cross(self.t1)) / squared_sine.sqrt();
        Table { cosine, lambda, squared_gap: gap * gap }
    }

    /// Sides of the control polygon for the root X.
    fn sides(&self, table: &Table, x: f64) -> ([f64; 2], [DVec3; 3]) {
        let [first, last] = [table.lambda[0] - x, -table.lambda[1] - x];
        let (departure, arrival) = (self.t0 * first, self.t1 * last);
        ([first, last], [departure, self.chord - departure - arrival, arrival])
    }

    /// Residual of conditions (17), relative to the squared size of the polygon. The squared length
    /// of the hodograph must be the square of a quadratic polynomial.
    fn residual(&self, table: &Table, x: f64) -> f64 {
        let ([first, last], [a, b, c]) = self.sides(table, x);
        let middle = b.dot(self.t0);
        let size = a.length_squared() + b.length_squared() + c.length_squared();
        let angles = middle - b.dot(self.t1);
        let squares = a.dot(c) + 2.0 * b.length_squared() - first * last - 2.0 * middle * middle;
        (angles.abs() / size.sqrt()).max(squares.abs() / size)
    }
}

impl Table {
    /// Linear and constant coefficients p, q of the equation (1 + 2c) X² + p X + q = 0.
    fn coefficients(&self, [lambda, mu]: [f64; 2]) -> [f64; 2] {
        [lambda + mu, 2.0 * self.squared_gap / (1.0 - self.cosine) - lambda * mu]
    }

    fn discriminant(&self) -> f64 {
        let [p, q] = self.coefficients([self.lambda[0], -self.lambda[1]]);
        p * p - 4.0 * (1.0 + 2.0 * self.cosine) * q
    }

    /// Roots for given λ₁ and −λ₂.
    fn roots(&self, lengths: [f64; 2]) -> Vec<f64> {
        let [p, q] = self.coefficients(lengths);
        let leading = 1.0 + 2.0 * self.cosine;
        let discriminant = p * p - 4.0 * leading * q;
        if discriminant < 0.0 {
            return Vec::new();
        }
        let half = -0.5 * (p + discriminant.sqrt().copysign(p));
        vec![half / leading, q / half]
    }
}

/// Uniform numbers in [−1, 1) from a linear congruential generator.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }
}

fn random_data(count: usize) -> Vec<Data> {
    let mut random = Random(20080301);
    (0..count).map(|_| Data::new(DVec3::ZERO, random.vector(), random.vector(), random.vector())).collect()
}

#[test]
fn signed_lambdas_are_correct_for_all_data_and_absolute_values_for_one_class_of_signs() {
    let mut roots_in_class = 0;
    let mut roots_elsewhere = 0;
    for data in random_data(4000) {
        let table = data.table();
        let [lambda, mu] = [table.lambda[0], -table.lambda[1]];
        for x in table.roots([lambda, mu]) {
            // Rounding is amplified up to a thousand times if tangents are nearly parallel or a
            // root is large.
            assert!(data.residual(&table, x) < 4e-12, "{data:?}: {:e}", data.residual(&table, x));
        }
        for x in table.roots([lambda.abs(), mu.abs()]) {
            let residual = data.residual(&table, x);
            if lambda > 0.0 && mu > 0.0 {
                roots_in_class += 1;
                assert!(residual < 4e-12, "{data:?}: {residual:e}");
            } else {
                // The error is comparable to the data. It is smallest if both values are nearly
                // zero.
                roots_elsewhere += 1;
                assert!(residual > 1e-6, "{data:?}: {residual:e}");
            }
        }
    }
    // A quarter of the data have these signs, and they have roots more often.
    assert!(roots_in_class > 1000 && roots_elsewhere > 3000, "{roots_in_class} and {roots_elsewhere}");
}

#[test]
fn random_data_have_the_known_solution_rates() {
    let count = 40_000;
    // Cases: no real root, then zero, one and two solutions that follow both tangents.
    let mut rates = [0.0; 4];
    for data in random_data(count) {
        let table = data.table();
        let [lambda, mu] = [table.lambda[0], -table.lambda[1]];
        let roots = table.roots([lambda, mu]);
        let valid: Vec<f64> = roots.iter().copied().filter(|&x| lambda - x > 0.0 && mu - x > 0.0).collect();
        let case = if roots.is_empty() { 0 } else { 1 + valid.len() };
        rates[case] += 1.0 / count as f64;
        match PhCubic::hermite(DVec3::ZERO, data.chord, data.t0, data.t1) {
            Err(PhCubicError::NoRealRoot { .. }) => assert_eq!(case, 0, "{data:?}"),
            Err(error) => assert_eq!((case, error), (1, PhCubicError::WrongDirection), "{data:?}"),
            Ok(cubic) => {
                let lengths = valid.iter().map(|&x| data.sides(&table, x).1.map(DVec3::length).iter().sum::<f64>());
                let shorter = lengths.fold(f64::INFINITY, f64::min);
                // The bound is due to the cancellation in table 1, not in the cubic.
                assert!((cubic.polygon_length() / shorter - 1.0).abs() < 1e-9, "{data:?}");
            }
        }
    }
    // The reference values are whole percentages. The standard deviation for 40,000 samples is a
    // quarter of a percent.
    for (rate, expected) in rates.into_iter().zip([0.57, 0.09, 0.25, 0.09]) {
        assert!((rate - expected).abs() < 0.0075, "{rates:?}");
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

#[test]
fn roots_are_golden() {
    for (end, t0, t1, golden) in [
        (v(1.0, 0.2, 0.1), v(1.0, 0.5, 0.0), v(1.0, -0.3, 0.4), 0.175247492842249),
        (v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.2), v(1.0, -1.0, 0.3), 0.213192849781166),
    ] {
        let table = Data::new(DVec3::ZERO, end, t0, t1).table();
        let [first, _, last] = PhCubic::hermite(DVec3::ZERO, end, t0, t1).unwrap().sides().map(DVec3::length);
        // The reference values have 15 digits.
        assert!((table.lambda[0] - first - golden).abs() < 1.5e-15);
        assert!((-table.lambda[1] - last - golden).abs() < 1.5e-15);
    }
}

#[test]
fn the_data_of_table_five_and_their_replacements_have_the_golden_numbers() {
    let (x0, x1) = (v(1000.0, 0.0, 0.0), v(1000.0, 2000.0, 4000.0));
    let table = |t0, t1| Data::new(x0, x1, t0, t1).table();
    let printed = table(v(1.0, 5.0, -1.0), v(-3.0, 2.0, 5.0));
    // Bounds: half a unit of the last digit.
    assert!((printed.lambda[0] - 915.1736).abs() < 5e-5 && (printed.lambda[1] + 3836.1715).abs() < 5e-5);
    assert!((printed.squared_gap.sqrt() - 2001.956).abs() < 5e-4 && (printed.cosine - 0.062439).abs() < 5e-7);
    assert!((printed.discriminant() + 96474.8849).abs() < 5e-5);
    for (found, golden) in [
        (table(v(1.0, 5.0, -1.0), v(3.0, -2.0, 5.0)), 33030547.5360722),
        (table(v(1.0, 5.0, 1.0), v(-3.0, -2.0, 5.0)), 70276428.792878),
    ] {
        assert!((found.discriminant() / golden - 1.0).abs() < 1e-14, "{}", found.discriminant());
    }
}

#[test]
fn short_arcs_keep_more_digits_than_the_printed_form() {
    // The curve (u, u²/2, u³/6) starts at the origin, so positions keep all digits. The first side
    // is a third of the length, up to a relative error of the order of the squared length.
    let curve = Bezier::new(vec![DVec3::ZERO, v(1.0, 0.0, 0.0) / 3.0, v(4.0, 1.0, 0.0) / 6.0, v(6.0, 3.0, 1.0) / 6.0]);
    for (length, bound, printed_error) in [(1e-6, 3e-7, 1e-5), (1e-7, 5e-5, 1e-3)] {
        let (start, end) = (curve.jet(0.0), curve.jet(length));
        let cubic = PhCubic::hermite(start.position, end.position, start.first, end.first).unwrap();
        let ratio = cubic.sides()[0].length() / (length / 3.0);
        assert!((ratio - 1.0).abs() < bound, "{length:e}: {:e}", ratio - 1.0);
        let data = Data::new(start.position, end.position, start.first, end.first);
        let table = data.table();
        let printed = table
            .roots([table.lambda[0].abs(), table.lambda[1].abs()])
            .iter()
            .map(|x| ((table.lambda[0] - x) / (length / 3.0) - 1.0).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(printed.is_nan() || printed > printed_error, "{length:e}: {printed:e}");
    }
}

#[test]
fn plane_cubics_have_a_constant_rotation() {
    let plane = PhCubic::hermite(DVec3::ZERO, v(1.0, 0.2, 0.0), v(1.0, 1.0, 0.0), v(1.0, -0.5, 0.0)).unwrap();
    assert_eq!((plane.rotation_factor(), plane.rotation_to(1.0)), (0.0, 0.0));
    for angle in [-2.0, 0.0, 0.7, 3.0] {
        let rotation = RationalRotation::with_initial_angle(&plane, angle).unwrap();
        assert_eq!(rotation.squared_error, 0.0);
        for at in [0.0, 0.4, 1.0] {
            // The angle is twice an arctangent of a tangent.
            assert!((rotation.angle(at) - angle).abs() < 2e-15, "W is constant");
        }
    }
}
