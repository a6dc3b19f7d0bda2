//! From the functions of a program to Cranelift's instructions: the same operations in the same order as the interpreter's.

use coadjoint::erased::dynamic::{FUSED, MACHINE_LANES};
use coadjoint_codegen::program::{Elementary, Function, Statement, Term, Value, stumpff};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{
    self, BlockArg, FuncRef, InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Type, types,
};
use cranelift_codegen::packed_option::ReservedValue;
use cranelift_frontend::FunctionBuilder;

use super::outside::{Outside, elementary};
use crate::assembler::Places;

/// Writes the instructions of one function, whose first parameter is the address of a frame.
pub(super) struct Emitter<'a, 'f> {
    pub(super) builder: FunctionBuilder<'f>,
    /// What is called.
    pub(super) outside: &'a mut dyn FnMut(Outside, &mut ir::Function) -> Option<FuncRef>,
    pub(super) pointer: Type,
    /// Whether several frames are gone through, side by side.
    pub(super) wide: bool,
    /// How many frames lie there number by number.
    pub(super) members: usize,
    /// How many registers there are of each number: those of the first frames.
    registers: usize,
    /// The address of the frame.
    pub(super) frame: ir::Value,
    /// Where Stumpff functions of large arguments are left to others. With a call for them, numbers could not stay in registers.
    pub(super) lost: Option<ir::Block>,
    /// What is known of the program's values, by their numbers.
    values: Vec<Option<Known>>,
    /// Whether something is called that there is not.
    pub(super) is_missing: bool,
}

/// How many registers a number takes at most.
const REGISTERS: usize = MACHINE_LANES / 2;

/// A number of each of several members, two in a register, or of one; or whether something holds of it.
///
/// Newton's steps wait for one operation after the other: while one register's do, the processor goes on with those of the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    registers: [ir::Value; REGISTERS],
    count: usize,
}

impl Number {
    pub(super) fn registers(&self) -> &[ir::Value] {
        &self.registers[..self.count]
    }
}

/// What is known of a value.
#[derive(Clone, Copy)]
pub(super) enum Known {
    Computed(Number),
    /// It stands in memory, so many places from an address, and has not been read yet.
    InMemory(ir::Value, usize),
}

/// Results of a function, array by array.
pub(super) type Arrays = Vec<Vec<Number>>;

impl<'a, 'f> Emitter<'a, 'f> {
    pub(super) fn new(
        builder: FunctionBuilder<'f>,
        outside: &'a mut dyn FnMut(Outside, &mut ir::Function) -> Option<FuncRef>,
        pointer: Type,
        members: usize,
        places: usize,
    ) -> Self {
        let (frame, values) = (ir::Value::from_u32(0), vec![None; places]);
        let wide = members > 1;
        let registers = (members / 2).clamp(1, REGISTERS);
        Self {
            builder,
            outside,
            pointer,
            wide,
            members,
            registers,
            frame,
            lost: None,
            values,
            is_missing: false,
        }
    }

    /// What is computed in each register.
    pub(super) fn in_each<const N: usize>(
        &mut self,
        of: [Number; N],
        mut compute: impl FnMut(&mut FunctionBuilder<'f>, [ir::Value; N]) -> ir::Value,
    ) -> Number {
        self.registers_of(|emitter, k| compute(&mut emitter.builder, of.map(|number| number.registers[k])))
    }

    /// The number with these registers, first to last.
    pub(super) fn registers_of(&mut self, mut of: impl FnMut(&mut Self, usize) -> ir::Value) -> Number {
        let mut number =
            Number { registers: [ir::Value::reserved_value(); REGISTERS], count: self.registers };
        for (k, register) in number.registers[..self.registers].iter_mut().enumerate() {
            *register = of(self, k);
        }
        number
    }

    /// A parameter of a block.
    pub(super) fn parameter(&mut self, block: ir::Block) -> Number {
        let ty = self.ty();
        self.registers_of(|emitter, _| emitter.builder.append_block_param(block, ty))
    }

    pub(super) fn add(&mut self, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().fadd(a, b))
    }

    pub(super) fn sub(&mut self, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().fsub(a, b))
    }

    pub(super) fn mul(&mut self, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().fmul(a, b))
    }

    pub(super) fn div(&mut self, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().fdiv(a, b))
    }

    fn neg(&mut self, x: Number) -> Number {
        self.in_each([x], |builder, [x]| builder.ins().fneg(x))
    }

    /// Whether a comparison holds of each.
    pub(super) fn compare(&mut self, condition: FloatCC, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().fcmp(condition, a, b))
    }

    /// Whether both hold; or the bits that both have.
    pub(super) fn and(&mut self, a: Number, b: Number) -> Number {
        self.in_each([a, b], |builder, [a, b]| builder.ins().band(a, b))
    }

    /// A function of frames that returns nothing.
    pub(super) fn whole<R>(&mut self, function: &Function<R>, places: &impl Places) {
        for argument in &function.arguments {
            let first = places.input(argument.input);
            for (value, place) in argument.values.iter().zip(first..) {
                if let Some(value) = value {
                    self.know(*value, Known::InMemory(self.frame, place));
                }
            }
        }
        self.body(function);
        let mut arrays = self.results(function);
        if places.is_least() {
            let least = arrays.concat().into_iter().reduce(|a, b| self.least(a, b));
            arrays = vec![least.into_iter().collect()];
        }
        let (fields, first) = places.record();
        let record: Vec<_> = fields.iter().map(|field| self.value(*field)).collect();
        // what is read was read
        for (array, numbers) in arrays.into_iter().enumerate() {
            self.store_all(self.frame, places.result(array), &numbers);
        }
        self.store_all(self.frame, first, &record);
        self.builder.ins().return_(&[]);
    }

    /// The statements of a function.
    pub(super) fn body<R>(&mut self, function: &Function<R>) {
        for statement in &function.statements {
            match statement {
                Statement::Let { value, term } => {
                    let computed = self.term(term);
                    self.know(*value, Known::Computed(computed));
                }
                Statement::Stumpff { values, argument } => {
                    let z = self.term(argument);
                    let members = self.stumpff(values, z);
                    for (value, member) in values.iter().flatten().zip(members) {
                        self.know(*value, Known::Computed(member));
                    }
                }
            }
        }
    }

    /// What a function returns.
    pub(super) fn results<R>(&mut self, function: &Function<R>) -> Arrays {
        function.results.iter().map(|array| array.iter().map(|term| self.term(term)).collect()).collect()
    }

    /// Lets values be those of an argument.
    pub(super) fn bind<'v>(&mut self, values: &[Option<Value>], given: impl IntoIterator<Item = &'v Number>) {
        for (value, given) in values.iter().zip(given) {
            if let Some(value) = value {
                self.know(*value, Known::Computed(*given));
            }
        }
    }

    /// Lets values be read from memory where they are needed.
    pub(super) fn bind_memory(&mut self, values: &[Option<Value>], address: ir::Value, first: usize) {
        for (value, place) in values.iter().zip(first..) {
            if let Some(value) = value {
                self.know(*value, Known::InMemory(address, place));
            }
        }
    }

    /// Knows none of so many values any more.
    pub(super) fn forget(&mut self, places: usize) {
        self.values = vec![None; places];
    }

    fn know(&mut self, value: Value, known: Known) {
        self.values[value.number()] = Some(known);
    }

    pub(super) fn value(&mut self, value: Value) -> Number {
        match self.values[value.number()] {
            Some(Known::Computed(computed)) => computed,
            Some(Known::InMemory(address, place)) => {
                let read = self.load(address, place);
                self.know(value, Known::Computed(read));
                read
            }
            // programs name nothing before it is computed
            None => self.number(f64::NAN),
        }
    }

    /// The type of a register.
    pub(super) fn ty(&self) -> Type {
        if self.wide { types::F64X2 } else { types::F64 }
    }

    pub(super) fn offset(&self, place: usize) -> i32 {
        (place * self.members * size_of::<f64>()) as i32
    }

    /// Memory that is there, where doubles are aligned and nothing more.
    pub(super) fn memory() -> MemFlagsData {
        MemFlagsData::new().with_notrap()
    }

    /// The same, of what is not written to as long as it is read through this address: it is read where it is needed.
    pub(super) fn lasting() -> MemFlagsData {
        Self::memory().with_readonly().with_can_move()
    }

    /// A number that lasts, or is read before anything is written.
    pub(super) fn load(&mut self, address: ir::Value, place: usize) -> Number {
        let (ty, offset) = (self.ty(), self.offset(place));
        self.load_as(ty, Self::lasting(), address, offset)
    }

    /// The number whose registers, of this type, stand here.
    pub(super) fn load_as(
        &mut self,
        ty: Type,
        flags: MemFlagsData,
        address: ir::Value,
        offset: i32,
    ) -> Number {
        self.registers_of(|emitter, k| emitter.builder.ins().load(ty, flags, address, offset + register(k)))
    }

    pub(super) fn store(&mut self, number: Number, address: ir::Value, place: usize) {
        let offset = self.offset(place);
        for (k, value) in number.registers().iter().enumerate() {
            self.builder.ins().store(Self::memory(), *value, address, offset + register(k));
        }
    }

    pub(super) fn store_all(&mut self, address: ir::Value, first: usize, numbers: &[Number]) {
        numbers.iter().zip(first..).for_each(|(number, place)| self.store(*number, address, place));
    }

    /// A constant, in all lanes.
    pub(super) fn number(&mut self, x: f64) -> Number {
        let all = if self.wide { self.twice(x) } else { self.scalar(x) };
        self.same(all)
    }

    /// What is in all registers.
    pub(super) fn same(&mut self, register: ir::Value) -> Number {
        self.registers_of(|_, _| register)
    }

    /// A constant of one lane.
    pub(super) fn scalar(&mut self, x: f64) -> ir::Value {
        if x.to_bits() == 0 {
            return self.builder.ins().f64const(x);
        }
        // read from beside the code: a number alone is put together by two instructions
        let both = self.twice(x);
        self.builder.ins().extractlane(both, 0)
    }

    /// A constant of two lanes.
    pub(super) fn twice(&mut self, x: f64) -> ir::Value {
        let bytes = [x.to_le_bytes(); 2].concat();
        let both = self.builder.func.dfg.constants.insert(bytes.into());
        self.builder.ins().vconst(types::F64X2, both)
    }

    /// A number of one lane, in all of them.
    pub(super) fn in_all_lanes(&mut self, number: ir::Value) -> Number {
        let all = if self.wide { self.builder.ins().splat(types::F64X2, number) } else { number };
        self.same(all)
    }

    /// `addend + a b`, or `addend − a b`, rounded as the library rounds it.
    pub(super) fn mul_add(&mut self, negative: bool, a: Number, b: Number, addend: Number) -> Number {
        if FUSED {
            let b = if negative { self.neg(b) } else { b };
            return self.in_each([a, b, addend], |builder, [a, b, addend]| builder.ins().fma(a, b, addend));
        }
        let product = self.mul(a, b);
        if negative { self.sub(addend, product) } else { self.add(addend, product) }
    }

    /// `yes` where the comparison holds.
    pub(super) fn select(&mut self, condition: Number, yes: Number, no: Number) -> Number {
        let wide = self.wide;
        self.in_each([condition, yes, no], |builder, [condition, yes, no]| {
            if !wide {
                return builder.ins().select(condition, yes, no);
            }
            let mask = builder.ins().bitcast(types::F64X2, little(), condition);
            let [mask, yes, no] = [mask, yes, no].map(|x| builder.ins().bitcast(types::I64X2, little(), x));
            let selected = builder.ins().bitselect(mask, yes, no);
            builder.ins().bitcast(types::F64X2, little(), selected)
        })
    }

    /// The lesser of two, of which one that is not a number is none.
    fn least(&mut self, a: Number, b: Number) -> Number {
        let is_second = self.compare(FloatCC::LessThan, b, a);
        let least = self.select(is_second, b, a);
        let is_none = self.compare(FloatCC::NotEqual, a, a);
        self.select(is_none, b, least)
    }

    /// The value of a term.
    pub(super) fn term(&mut self, term: &Term) -> Number {
        match term {
            Term::Number(number) => self.number(number.as_emitted()),
            Term::Value(value) => self.value(*value),
            Term::Negative(x) => {
                let x = self.term(x);
                self.neg(x)
            }
            Term::Sum(addends) => {
                let mut sum = None;
                for (negative, addend) in addends {
                    let addend = self.term(addend);
                    sum = Some(match (sum, negative) {
                        (None, _) => addend,
                        (Some(sum), false) => self.add(sum, addend),
                        (Some(sum), true) => self.sub(sum, addend),
                    });
                }
                sum.unwrap_or_else(|| self.number(0.0))
            }
            Term::Product(factors) => {
                let mut product = None;
                for factor in factors {
                    let factor = self.term(factor);
                    product = Some(match product {
                        None => factor,
                        Some(product) => self.mul(product, factor),
                    });
                }
                product.unwrap_or_else(|| self.number(1.0))
            }
            Term::MulAdd { negative, a, b, addend } => {
                let [a, b, addend] = [a, b, addend].map(|term| self.term(term));
                self.mul_add(*negative, a, b, addend)
            }
            Term::Quotient(x, y) => {
                let [x, y] = [x, y].map(|term| self.term(term));
                self.div(x, y)
            }
            Term::Power(x, y) => self.called(Outside::Power, &[x, y]),
            Term::Atan2(y, x) => self.called(Outside::Atan2, &[y, x]),
            Term::Choice([x, yes, no]) => {
                let [x, yes, no] = [x, yes, no].map(|term| self.term(term));
                let zero = self.number(0.0);
                let is_negative = self.compare(FloatCC::LessThan, x, zero);
                self.select(is_negative, yes, no)
            }
            Term::Function(Elementary::Sqrt, x) => {
                let x = self.term(x);
                self.in_each([x], |builder, [x]| builder.ins().sqrt(x))
            }
            Term::Function(function, x) => self.called(elementary(*function), &[x]),
        }
    }

    fn outside(&mut self, outside: Outside) -> Option<FuncRef> {
        let function = (self.outside)(outside, self.builder.func);
        self.is_missing |= function.is_none();
        function
    }

    /// A number from outside, of each lane.
    fn called(&mut self, outside: Outside, operands: &[&Term]) -> Number {
        let operands: Vec<_> = operands.iter().map(|term| self.term(term)).collect();
        let Some(function) = self.outside(outside) else { return self.number(f64::NAN) };
        self.registers_of(|emitter, k| {
            let operands: Vec<_> = operands.iter().map(|number| number.registers[k]).collect();
            let [number] = emitter.in_lanes(&operands, |emitter, operands| {
                let call = emitter.builder.ins().call(function, operands);
                [emitter.builder.inst_results(call)[0]]
            });
            number
        })
    }

    /// What is computed lane by lane of what is in registers, in registers again.
    fn in_lanes<R: AsMut<[ir::Value]>>(
        &mut self,
        registers: &[ir::Value],
        mut of: impl FnMut(&mut Self, &[ir::Value]) -> R,
    ) -> R {
        if !self.wide {
            return of(self, registers);
        }
        let [mut first, mut second] = [0, 1].map(|lane| {
            let lanes: Vec<_> = registers.iter().map(|x| self.builder.ins().extractlane(*x, lane)).collect();
            of(self, &lanes)
        });
        for (first, second) in first.as_mut().iter_mut().zip(second.as_mut()) {
            let both = self.builder.ins().splat(types::F64X2, *first);
            *first = self.builder.ins().insertlane(both, *second, 1);
        }
        first
    }

    /// Whether a comparison holds in all lanes.
    pub(super) fn all(&mut self, condition: Number) -> ir::Value {
        let mut all = condition.registers[0];
        for condition in &condition.registers()[1..] {
            all = self.builder.ins().band(all, *condition);
        }
        if !self.wide {
            return all;
        }
        let lanes = self.builder.ins().vhigh_bits(types::I32, all);
        self.builder.ins().icmp_imm_s(IntCC::Equal, lanes, 0b11)
    }

    /// Stumpff functions, those that are used: of small arguments here, of others by a call.
    fn stumpff(&mut self, values: &[Option<Value>], z: Number) -> Vec<Number> {
        let count = values.len();
        let used: Vec<usize> = (0..count).filter(|k| values[*k].is_some()).collect();
        let [brief, farther, short, far, joined] = std::array::from_fn(|_| self.builder.create_block());
        let given: Vec<_> = used.iter().map(|_| self.parameter(joined)).collect();
        self.builder.set_cold_block(far);
        let size = self.in_each([z], |builder, [z]| builder.ins().fabs(z));
        for (limit, [near, other]) in
            [(stumpff::brief(count), [brief, farther]), (stumpff::SHORT, [short, far])]
        {
            let limit = self.number(limit);
            let is_near = self.compare(FloatCC::LessThan, size, limit);
            let is_near = self.all(is_near);
            self.builder.ins().brif(is_near, near, &[], other, &[]);
            self.builder.switch_to_block(other);
        }
        // `other` is where it is far
        if let Some(lost) = self.lost {
            self.builder.ins().jump(lost, &[]);
        } else {
            let called = self.stumpff_called(count, z);
            self.join(joined, &used, &called);
        }
        for (block, quartets) in [(brief, 1), (short, 2)] {
            self.builder.switch_to_block(block);
            let members = self.series(count, quartets, z);
            self.join(joined, &used, &members);
        }
        self.builder.switch_to_block(joined);
        given
    }

    fn join(&mut self, block: ir::Block, used: &[usize], members: &[Number]) {
        let given = block_args(used.iter().map(|k| &members[*k]));
        self.builder.ins().jump(block, &given);
    }

    /// Stumpff functions from series of so many quartets, one or two.
    fn series(&mut self, count: usize, quartets: usize, z: Number) -> Vec<Number> {
        let z2 = self.mul(z, z);
        let z4 = (quartets > 1).then(|| self.mul(z2, z2));
        let highest = stumpff::highest(count).map(|k| {
            let first = self.quartet(k, z, z2);
            match z4 {
                Some(z4) => {
                    let second = self.quartet(k + 8, z, z2);
                    self.mul_add(false, z4, second, first)
                }
                None => first,
            }
        });
        let mut members = vec![highest[0]; count];
        members[count - 1] = highest[1];
        for k in (0..count.saturating_sub(2)).rev() {
            let constant = self.number(stumpff::inverse_factorial(k));
            members[k] = self.mul_add(true, z, members[k + 2], constant);
        }
        members
    }

    fn quartet(&mut self, k: usize, z: Number, z2: Number) -> Number {
        let constants = [0, 2, 4, 6].map(|j| self.number(stumpff::inverse_factorial(k + j)));
        let low = self.mul_add(true, z, constants[1], constants[0]);
        let high = self.mul_add(true, z, constants[3], constants[2]);
        self.mul_add(false, z2, high, low)
    }

    fn stumpff_called(&mut self, count: usize, z: Number) -> Vec<Number> {
        let function = self.outside(Outside::Stumpff).filter(|_| count <= stumpff::MAX);
        let Some(function) = function else {
            self.is_missing = true;
            return vec![z; count];
        };
        let size = (count * size_of::<f64>()) as u32;
        let slot =
            self.builder.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, size, 3));
        let pointer = self.pointer;
        let of = |emitter: &mut Self, z: &[ir::Value]| -> Vec<ir::Value> {
            let count_of = emitter.builder.ins().iconst(pointer, count as i64);
            let address = emitter.builder.ins().stack_addr(pointer, slot, 0);
            emitter.builder.ins().call(function, &[count_of, z[0], address]);
            (0..count)
                .map(|k| {
                    emitter.builder.ins().stack_load(pointer, types::F64, slot, (k * size_of::<f64>()) as i32)
                })
                .collect()
        };
        let registers: Vec<_> = z.registers().iter().map(|z| self.in_lanes(&[*z], of)).collect();
        (0..count).map(|member| self.registers_of(|_, k| registers[k][member])).collect()
    }
}

/// Where a register stands after the first.
const fn register(k: usize) -> i32 {
    (k * 2 * size_of::<f64>()) as i32
}

/// What blocks are given: all registers.
pub(super) fn block_args<'n>(numbers: impl IntoIterator<Item = &'n Number>) -> Vec<BlockArg> {
    numbers.into_iter().flat_map(Number::registers).map(|register| (*register).into()).collect()
}

fn little() -> MemFlagsData {
    MemFlagsData::new().with_endianness(ir::Endianness::Little)
}
