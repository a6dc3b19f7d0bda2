//! The derivative of a step, interpreted.

use coadjoint::__private::Scalar;
use coadjoint::erased::Jacobian;
use coadjoint::erased::dynamic::{Solution, StepDerivative};
use coadjoint::nalgebra::DMatrix;
use coadjoint_codegen::program::{DerivativeRole, Input, Interface, Module, RecordKind, Term};

use crate::in_one_frame::InOneFrame;

/// The functions of a derivative.
pub(crate) struct Derivative {
    functions: InOneFrame<DerivativeRole>,
    /// How many numbers a perturbation of the state has.
    rows: usize,
    /// The derivatives with respect to state, controls and parameters.
    matrices: [Matrix; 3],
}

/// A matrix whose columns are `explicit + through · unknown`, each of two arrays.
struct Matrix {
    role: DerivativeRole,
    /// How many columns it has: none that are not asked for.
    width: usize,
    /// Whether the second array of a column is zero by its form: that adds nothing, not even where the other factor is infinite.
    is_explicit: Vec<bool>,
}

impl Derivative {
    /// The derivative that a module has.
    pub(crate) fn boxed(module: &Module<DerivativeRole>, interface: &Interface) -> Box<dyn StepDerivative> {
        let is_zero = |term: &Term| matches!(term, Term::Number(number) if number.is_zero());
        let matrix = |(role, width)| {
            let function = module.function(role);
            let results = function.map_or(&[][..], |function| &function.results);
            let width = if function.is_some() { width } else { 0 };
            let is_explicit = results.chunks_exact(2).map(|pair| pair[1].iter().all(is_zero)).collect();
            Matrix { role, width, is_explicit }
        };
        let matrices = [
            (DerivativeRole::WrtState, interface.state_perturbation()),
            (DerivativeRole::WrtControl, interface.control_length()),
            (DerivativeRole::WrtParameters, interface.field_length()),
        ];
        Box::new(Self {
            functions: InOneFrame::new(module, RecordKind::Point),
            rows: interface.state_perturbation(),
            matrices: matrices.map(matrix),
        })
    }
}

impl StepDerivative for Derivative {
    fn jacobian(&self, at: &Solution<'_>) -> Jacobian {
        let functions = &self.functions;
        let frame = &mut functions.frame();
        let given = [
            (Input::Parameters, at.parameters),
            (Input::StepSize, &[at.step_size]),
            (Input::State, at.state),
            (Input::Time, &[at.time]),
            (Input::Control, at.control),
            (Input::Unknown, at.unknown),
        ];
        given.into_iter().for_each(|(input, numbers)| functions.give(frame, input, numbers));
        functions.call(frame, DerivativeRole::Point);
        let through = functions.call(frame, DerivativeRole::Through);
        let [state, control, parameters] = self.matrices.each_ref().map(|matrix| {
            let columns = functions.call(frame, matrix.role).chunks_exact(2);
            let mut dense = DMatrix::zeros(self.rows, matrix.width);
            for ((pair, is_explicit), mut to) in columns.zip(&matrix.is_explicit).zip(dense.column_iter_mut())
            {
                to.copy_from_slice(&frame[pair[0].clone()]);
                let unknown = if *is_explicit { 0..0 } else { pair[1].clone() };
                for (through, by) in through.iter().zip(&frame[unknown]) {
                    for (to, entry) in to.iter_mut().zip(&frame[through.clone()]) {
                        *to = Scalar::mul_add(*entry, *by, *to);
                    }
                }
            }
            dense
        });
        Jacobian { state, control, parameters }
    }
}
