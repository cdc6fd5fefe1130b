//! The tool of a robot in the reference frame: placement, Jacobian, and how the Jacobian changes.

use crate::motion::AxisKind;
use crate::robot::Robot;
use blocksim_multibody::{BodyId, Data, Placement, forward_kinematics};
use nalgebra::{DMatrix, Vector3};

/// A robot with the workspace of its kinematics.
pub(crate) struct Arm<'r> {
    robot: &'r Robot,
    data: Data,
    bodies: Vec<BodyId>,
    to_reference: Placement,
    /// Each axis in the reference.
    axes: Vec<Axis>,
    /// The tool in the reference, as of the last [`Arm::look`].
    pub tool: Placement,
    /// `(ω; v) = J q̇` of the tool in the axes of the reference, as of the last [`Arm::look`].
    pub jacobian: DMatrix<f64>,
    /// Derivative of the Jacobian, as of the last [`Arm::look_moving`].
    pub slope: DMatrix<f64>,
}

/// An axis as it is at the moment.
#[derive(Clone, Copy)]
struct Axis {
    kind: AxisKind,
    /// In the frame of its link.
    along: Vector3<f64>,
    direction: Vector3<f64>,
    origin: Vector3<f64>,
}

impl<'r> Arm<'r> {
    pub fn new(robot: &'r Robot) -> Self {
        let n = robot.axes();
        let model = robot.model();
        let data = model.data();
        let to_reference = robot.reference().in_world(&data).inverse();
        let axis = |part: &crate::robot::Link| Axis {
            kind: part.limits.kind,
            along: Vector3::from(part.axis).normalize(),
            direction: Vector3::zeros(),
            origin: Vector3::zeros(),
        };
        Arm {
            robot,
            data,
            bodies: model.bodies().collect(),
            to_reference,
            axes: robot.parts().links.iter().map(axis).collect(),
            tool: Placement::identity(),
            jacobian: DMatrix::zeros(6, n),
            slope: DMatrix::zeros(6, n),
        }
    }

    /// Placement and Jacobian at `q`.
    pub fn look(&mut self, q: &[f64]) {
        forward_kinematics(self.robot.model(), &mut self.data, q);
        self.tool = self.to_reference * self.robot.tool().in_world(&self.data);
        let tip = self.tool.translation;
        for (i, body) in self.bodies.iter().enumerate() {
            let at = self.to_reference * *self.data.placement(*body);
            let axis = &mut self.axes[i];
            (axis.direction, axis.origin) = (at.direction(&axis.along), at.translation);
            let (angular, linear) = match axis.kind {
                AxisKind::Turning => (axis.direction, axis.direction.cross(&(tip - axis.origin))),
                AxisKind::Sliding => (Vector3::zeros(), axis.direction),
            };
            put(&mut self.jacobian, i, &angular, &linear);
        }
    }

    /// As [`Arm::look`], and the derivative of the Jacobian where the joints move by `dq`.
    pub fn look_moving(&mut self, q: &[f64], dq: &[f64]) {
        self.look(q);
        let tip = self.tool.translation;
        let motion = |rows: usize| -> Vector3<f64> {
            let product = self.jacobian.rows(rows, 3) * nalgebra::DVector::from_column_slice(dq);
            Vector3::new(product[0], product[1], product[2])
        };
        let tip_speed = motion(3);
        // along the chain: angular velocity of each link, speed of its origin
        let (mut omega, mut speed) = (Vector3::zeros(), Vector3::zeros());
        for (i, axis) in self.axes.iter().enumerate() {
            if let Some(before) = i.checked_sub(1).map(|k| self.axes[k]) {
                speed += omega.cross(&(axis.origin - before.origin));
            }
            let turned = omega.cross(&axis.direction);
            match axis.kind {
                AxisKind::Turning => {
                    omega += axis.direction * dq[i];
                    let lever = turned.cross(&(tip - axis.origin));
                    let moved = lever + axis.direction.cross(&(tip_speed - speed));
                    put(&mut self.slope, i, &turned, &moved);
                }
                AxisKind::Sliding => {
                    speed += axis.direction * dq[i];
                    put(&mut self.slope, i, &Vector3::zeros(), &turned);
                }
            }
        }
    }
}

fn put(matrix: &mut DMatrix<f64>, column: usize, angular: &Vector3<f64>, linear: &Vector3<f64>) {
    for row in 0..3 {
        matrix[(row, column)] = angular[row];
        matrix[(3 + row, column)] = linear[row];
    }
}

#[cfg(test)]
mod tests {
    use crate::motion::AxisLimits;
    use crate::robot::{Drive, Link, Parts, Robot, TcpLimits};

    use super::*;

    /// Four axes askew, of which two slide.
    fn robot() -> Robot {
        let link = |(seat, rpy, axis, kind)| Link {
            name: String::new(),
            origin: Placement::from_rpy(seat, rpy),
            axis,
            limits: AxisLimits { kind, lower: -2.0, upper: 2.0, speed: 1.0, acceleration: 9.0 },
            start: 0.0,
            solids: Vec::new(),
            drive: Drive::default(),
        };
        let links = [
            ([0.0, 0.1, 0.4], [0.1, 0.2, 0.3], [0.0, 0.0, 1.0], AxisKind::Turning),
            ([0.3, 0.0, 0.1], [-0.4, 0.0, 0.7], [1.0, 0.5, 0.0], AxisKind::Sliding),
            ([0.2, 0.1, 0.0], [0.0, 0.9, 0.0], [0.0, 1.0, 0.2], AxisKind::Turning),
            ([0.0, 0.1, 0.3], [0.2, 0.0, 0.0], [0.3, 0.0, 1.0], AxisKind::Sliding),
        ];
        Robot::new(Parts {
            name: String::new(),
            gravity: [0.0; 3],
            base: Placement::from_rpy([0.3, -0.2, 0.1], [0.0, 0.3, 0.4]),
            reference: Placement::from_rpy([0.0, 0.4, 0.0], [0.5, 0.0, 0.0]),
            links: links.map(link).to_vec(),
            flange: Placement::from_translation([0.0, 0.0, 0.2]),
            tool: Placement::from_translation([0.1, 0.0, 0.1]),
            tcp_limits: TcpLimits { speed: 1.0, acceleration: 1.0 },
        })
        .expect("a robot")
    }

    #[test]
    fn the_jacobian_and_its_slope_are_derivatives_where_axes_turn_and_slide() {
        const H: f64 = 1e-6;
        let (robot, q, dq) = (robot(), [0.4, -0.3, 0.8, 0.5], [0.7, -0.9, 0.6, 1.1]);
        let at = |share: f64| -> Arm {
            let moved: Vec<f64> = q.iter().zip(dq).map(|(q, dq)| q + share * dq).collect();
            let mut arm = Arm::new(&robot);
            arm.look_moving(&moved, &dq);
            arm
        };
        let [before, here, after] = [-H, 0.0, H].map(at);
        let speed = (after.tool.translation - before.tool.translation) / (2.0 * H);
        let by_jacobian = &here.jacobian * nalgebra::DVector::from_column_slice(&dq);
        assert!((speed - by_jacobian.fixed_rows::<3>(3)).norm() < 1e-9);
        let turned = after.tool.rotation * before.tool.rotation.transpose();
        let turn = blocksim_multibody::rotation_vector(&turned) / (2.0 * H);
        assert!((turn - by_jacobian.fixed_rows::<3>(0)).norm() < 1e-9);
        let slope = (after.jacobian - before.jacobian) / (2.0 * H);
        assert!((slope - here.slope).amax() < 1e-9);
    }
}
