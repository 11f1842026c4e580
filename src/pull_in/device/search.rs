//! The search for the first maximum of a curve on a grid.

use super::{Curves, Fold, Point};

impl Curves {
    /// The first point at which `slope` goes from above to below zero.
    pub(super) fn first_fold(
        &self,
        points: impl Iterator<Item = Point>,
        slope: impl Fn(Point) -> f64,
        value: impl Fn(Point) -> f64,
    ) -> Option<Fold> {
        let mut points = points.take_while(|point| self.pulls(*point));
        let mut before: [Option<(Point, f64)>; 2] = [None, None];
        while let Some(point) = points.next() {
            let here = slope(point);
            let top = match before {
                [_, Some((last, rising))] if rising > 0.0 && here <= 0.0 => {
                    Some(self.between(last, point, &slope))
                }
                // Next to the wall the slope is infinite at one point after another.
                [Some((first, high)), Some((last, low))]
                    if low > 0.0 && low < f64::INFINITY && low <= high && low <= here =>
                {
                    self.dip(first, point, &slope)
                        .map(|dip| self.between(first_of(first, last, dip), dip, &slope))
                }
                _ => None,
            };
            if let Some(top) = top {
                let rest = std::iter::once(point).chain(points);
                return Some(self.fold_at(top, value(top), rest, value));
            }
            before = [before[1], Some((point, here))];
        }
        None
    }

    /// Whether the field stretches the actuator at a point: the permittivity may fall too fast.
    pub(super) fn pulls(&self, point: Point) -> bool {
        let stretch = self.stretch(point);
        let [value, _] = self.still.permittivity.at(stretch);
        value > 0.0 && self.still.permittivity.pull(stretch) > 0.0
    }

    pub(super) fn fold_at(
        &self,
        top: Point,
        height: f64,
        beyond: impl Iterator<Item = Point>,
        value: impl Fn(Point) -> f64,
    ) -> Fold {
        let mut last = top;
        let mut snaps_to = None;
        let mut has_fallen = false;
        for point in beyond.take_while(|point| self.pulls(*point)) {
            if value(point) < height {
                has_fallen = true;
            } else if has_fallen {
                let rising = self.between(last, point, &|p| height - value(p));
                snaps_to = Some(self.stretch(rising));
                break;
            }
            last = point;
        }
        Fold {
            voltage: height.max(0.0).sqrt(),
            stretch: self.stretch(top),
            snaps_to,
        }
    }

    /// The last point between two at which `slope` is above zero, where it is at the first.
    pub(super) fn between(&self, from: Point, to: Point, slope: &impl Fn(Point) -> f64) -> Point {
        let from = self.seen_as(from, to);
        let position = bisect(from.position, to.position, |position| {
            slope(Point { position, ..to }) > 0.0
        });
        Point { position, ..to }
    }

    /// The lowest point of `slope` between two, if it is not above zero there.
    pub(super) fn dip(
        &self,
        from: Point,
        to: Point,
        slope: &impl Fn(Point) -> f64,
    ) -> Option<Point> {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let mut low = self.seen_as(from, to).position;
        let mut high = to.position;
        let at = |position: f64| slope(Point { position, ..to });
        for _ in 0..60 {
            let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
            if at(a) < at(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let position = 0.5 * (low + high);
        (at(position) <= 0.0).then_some(Point { position, ..to })
    }

    /// A point with its position counted as that of another.
    pub(super) fn seen_as(&self, point: Point, other: Point) -> Point {
        let shift = self.origin(point).sub(self.origin(other));
        Point {
            position: shift.plus(point.position).value(),
            ..other
        }
    }
}

/// Of two points before a dip, the last one that lies before it.
fn first_of(first: Point, last: Point, dip: Point) -> Point {
    if last.near_wall == dip.near_wall && last.position < dip.position {
        last
    } else {
        first
    }
}

/// The last number between `from`, where a condition holds, and `to`, where it does not.
pub(super) fn bisect(mut from: f64, mut to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = from.midpoint(to);
        if middle == from || middle == to {
            return from;
        }
        if holds(middle) {
            from = middle;
        } else {
            to = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::super::RELAXED;
    use super::*;
    use crate::actuator::Parameters;
    use crate::actuator::device::{Device, Elasticity, Locking};

    /// A material that locks before it could pull in: next to the wall every slope is infinite, and no dip.
    #[test]
    fn a_curve_without_a_fold_is_looked_at_a_few_hundred_times() {
        let sheet = Parameters {
            aspect: 100.0,
            surface_energy: 0.0,
            surface_tension: 0.0,
            surface_elasticity: 0.0,
        };
        let device = Device {
            elasticity: Elasticity::Gent(Locking::new(5.0)),
            ..Device::plain(sheet)
        };
        let curves = Curves::new(&device, RELAXED, 0.0).expect("a voltage is imposed");
        let looks = Cell::new(0);
        let slope = |point: Point| {
            looks.set(looks.get() + 1);
            curves.supply(point).slope()
        };
        let value = |point: Point| curves.supply(point).term[0];
        assert_eq!(curves.first_fold(curves.grid(), slope, value), None);
        assert!((100..1000).contains(&looks.get()), "{}", looks.get());
    }
}
