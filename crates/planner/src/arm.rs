//! The tool of a robot in the reference frame: placement, Jacobian, and how the Jacobian changes.

use blocksim_multibody::{BodyId, Data, Joint, Placement, forward_kinematics};
use blocksim_robot::Robot;
use nalgebra::{DMatrix, Vector3};

/// A robot with the workspace of its kinematics.
pub(crate) struct Arm<'r> {
    robot: &'r Robot,
    data: Data,
    bodies: Vec<BodyId>,
    to_reference: Placement,
    /// Direction and origin of each axis in the reference.
    axes: Vec<(Vector3<f64>, Vector3<f64>)>,
    /// The tool in the reference, as of the last [`Arm::look`].
    pub tool: Placement,
    /// `(ω; v) = J q̇` of the tool in the axes of the reference, as of the last [`Arm::look`].
    pub jacobian: DMatrix<f64>,
    /// Derivative of the Jacobian, as of the last [`Arm::look_moving`].
    pub slope: DMatrix<f64>,
}

impl<'r> Arm<'r> {
    pub fn new(robot: &'r Robot) -> Self {
        let n = robot.axes();
        let model = robot.model();
        let data = model.data();
        let to_reference = robot.reference().in_world(&data).inverse();
        Arm {
            robot,
            data,
            bodies: model.bodies().collect(),
            to_reference,
            axes: vec![(Vector3::zeros(), Vector3::zeros()); n],
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
            let direction = match self.robot.model().joint(*body) {
                Joint::Revolute { axis } => at.direction(axis),
                // a robot is made of turning axes
                _ => Vector3::zeros(),
            };
            self.axes[i] = (direction, at.translation);
            put(&mut self.jacobian, i, &direction, &direction.cross(&(tip - at.translation)));
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
        // along the chain: angular velocity of each link, speed of the origin of its axis
        let (mut omega, mut speed) = (Vector3::zeros(), Vector3::zeros());
        for (i, (direction, origin)) in self.axes.iter().enumerate() {
            if let Some((_, before)) = i.checked_sub(1).map(|k| self.axes[k]) {
                speed += omega.cross(&(origin - before));
            }
            omega += direction * dq[i];
            let turned = omega.cross(direction);
            let moved = turned.cross(&(tip - origin)) + direction.cross(&(tip_speed - speed));
            put(&mut self.slope, i, &turned, &moved);
        }
    }
}

fn put(matrix: &mut DMatrix<f64>, column: usize, angular: &Vector3<f64>, linear: &Vector3<f64>) {
    for row in 0..3 {
        matrix[(row, column)] = angular[row];
        matrix[(3 + row, column)] = linear[row];
    }
}
