//! The functions of a step as machine code, by Cranelift.
//!
//! Code reads and writes frames, as the interpreter does, at places that were known when it was written, and calls what is in [`outside`]. It has
//! no addresses but these, and does not panic. Where there is none to be made, of a processor that Cranelift does not know or of memory that may
//! not be executed, the interpreter does the work.
#![allow(unsafe_code, reason = "machine code is called")]

mod emit;
mod march;
mod outside;

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

use coadjoint::erased::dynamic::{LANES, Layout, MACHINE_LANES, March, Marching, StepFunction, row_length};
use coadjoint_codegen::program::{Function, Module, Program, StepRole};
use cranelift_codegen::ir::{self, AbiParam, Signature};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module as _, default_libcall_names};

use self::emit::Emitter;
use self::outside::Outside;
use crate::STACK;
use crate::definition::{FUNCTIONS, InStep, layout};

/// A function of a frame.
type Call = unsafe extern "C" fn(*mut f64);

/// The processor that this runs on, if it is known.
static PROCESSOR: LazyLock<Option<OwnedTargetIsa>> = LazyLock::new(|| {
    let mut flags = settings::builder();
    let options = [
        ("opt_level", "speed"),
        // the addresses of what is called are anywhere
        ("use_colocated_libcalls", "false"),
        ("is_pic", "false"),
        // so that no frame of a function goes past what guards the stack
        ("enable_probestack", "true"),
        ("probestack_strategy", "inline"),
        ("unwind_info", "false"),
        // what is written is the same for all programs: tests of the catalogue have tried it
        ("enable_verifier", "false"),
    ];
    options.iter().try_for_each(|(name, value)| flags.set(name, value)).ok()?;
    cranelift_native::builder().ok()?.finish(settings::Flags::new(flags)).ok()
});

/// Whether machine code can be made.
fn is_here() -> bool {
    PROCESSOR.is_some()
}

/// How many members functions may be for.
const MEMBERS: [usize; 3] = [1, MACHINE_LANES, LANES];

/// A step's functions, compiled when they are needed.
pub(crate) struct Machine {
    program: Arc<Program>,
    /// Which of its steps it is.
    place: usize,
    layout: Layout,
    /// Those that nearly all steps need, and the others, for as many members side by side as [`MEMBERS`] says.
    functions: [[OnceLock<Option<Functions>>; 2]; MEMBERS.len()],
    marches: Mutex<Marches>,
}

/// What takes many steps at a time, of one alone or of it and another one, with so many members.
type Marches = HashMap<(Option<usize>, usize), Option<March>>;

/// Functions that are compiled.
struct Functions {
    calls: [Option<Call>; 8],
    _code: Code,
}

impl Machine {
    pub(crate) fn new(program: Arc<Program>, place: usize, layout: Layout) -> Self {
        Self { program, place, layout, functions: Default::default(), marches: Mutex::default() }
    }

    /// The functions of which this is one.
    fn functions(&self, function: StepFunction, members: usize) -> Option<&Functions> {
        let is_rare = |function| function == StepFunction::Correction && is_here();
        let rare = is_rare(function);
        let compile = |compiler: &mut Compiler| {
            let step = &self.program.steps[self.place];
            let mut ids = [None; 8];
            for (id, (function, role)) in ids.iter_mut().zip(FUNCTIONS) {
                if let Some(code) = step.module.function(role).filter(|_| is_rare(function) == rare) {
                    *id = Some(compiler.function(&step.module, code, &self.layout)?);
                }
            }
            Some(ids)
        };
        let place = MEMBERS.iter().position(|count| *count == members)?;
        let made = self.functions[place][usize::from(rare)].get_or_init(|| {
            let (ids, code) = compiled(members, compile)?;
            // SAFETY: they were compiled with this signature
            let call = |id| unsafe { std::mem::transmute::<*const u8, Call>(code.address(id)) };
            Some(Functions { calls: ids.map(|id| id.map(call)), _code: code })
        });
        made.as_ref()
    }

    /// Calls a function on a frame, if there is code for it.
    pub(crate) fn call(&self, function: StepFunction, frame: &mut [f64]) -> bool {
        let Some(functions) = self.functions(function, 1) else { return false };
        if frame.len() < self.layout.scratch {
            return false;
        }
        if let Some(call) = functions.calls[function as usize] {
            // SAFETY: it reads and writes places of the layout alone
            unsafe { call(frame.as_mut_ptr()) };
        }
        true
    }

    /// The same on frames side by side, [`MACHINE_LANES`] at a time.
    pub(crate) fn call_wide<const L: usize>(&self, function: StepFunction, frame: &mut [[f64; L]]) -> bool {
        let Some(functions) = self.functions(function, L) else { return false };
        if frame.len() < self.layout.scratch {
            return false;
        }
        if let Some(call) = functions.calls[function as usize] {
            let first: *mut f64 = frame.as_mut_ptr().cast();
            for some in 0..L / MACHINE_LANES {
                // SAFETY: it reads and writes so many lanes of places of the layout alone
                unsafe { call(first.add(MACHINE_LANES * some)) };
            }
        }
        true
    }

    /// Whether there may be what takes many steps at a time.
    pub(crate) fn has_march(&self) -> bool {
        is_here()
    }

    /// What takes many steps at a time.
    pub(crate) fn march(&self, then: Option<usize>, members: usize) -> Option<March> {
        let mut marches = self.marches.lock().unwrap_or_else(PoisonError::into_inner);
        marches.entry((then, members)).or_insert_with(|| self.marching(then, members)).clone()
    }

    fn marching(&self, then: Option<usize>, members: usize) -> Option<March> {
        let places = std::iter::once(self.place).chain(then);
        let steps = places.map(|place| self.program.steps.get(place)).collect::<Option<Vec<_>>>()?;
        let layouts: Vec<Layout> = steps.iter().map(|step| layout(&self.program.interface, step)).collect();
        let stages: Vec<_> = steps.into_iter().zip(&layouts).collect();
        let (id, code) = compiled(members, |compiler| march::defined(compiler, &stages))?;
        // SAFETY: it was compiled with this signature
        let call = unsafe {
            std::mem::transmute::<*const u8, unsafe extern "C" fn(*mut Marching)>(code.address(id))
        };
        let lengths = layouts
            .iter()
            .map(|layout| [members * layout.scratch, row_length(layout.unknown.len(), members)]);
        // SAFETY: the code is the owner, and goes by the layouts of such frames and such rows
        Some(unsafe { March::new(call, lengths.collect(), Arc::new(code)) })
    }
}

/// What is compiled with as much stack as what derived it; none if it cannot be.
fn compiled<R: Send>(
    members: usize,
    compile: impl FnOnce(&mut Compiler) -> Option<R> + Send,
) -> Option<(R, Code)> {
    let processor = PROCESSOR.clone()?;
    let all = || {
        let mut compiler = Compiler::new(processor, members);
        let made = compile(&mut compiler)?;
        if compiler.is_missing {
            return None;
        }
        compiler.code.module().finalize_definitions().ok()?;
        Some((made, compiler.code))
    };
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("machine code".to_owned()).stack_size(STACK);
        thread.spawn_scoped(scope, all).ok()?.join().ok()?
    })
}

/// Code in memory, which is freed with it.
struct Code(Option<JITModule>);

// SAFETY: what is in there is not written to once the functions are finished, and until then it has one owner
unsafe impl Send for Code {}
// SAFETY: as above; through a reference there is nothing to be had but addresses
unsafe impl Sync for Code {}

impl Code {
    fn module(&mut self) -> &mut JITModule {
        // nothing but `drop` takes it, and nobody calls this from there
        self.0.as_mut().expect("there is one until this is dropped")
    }

    fn address(&self, id: FuncId) -> *const u8 {
        self.0.as_ref().map_or(std::ptr::null(), |module| module.get_finalized_function(id))
    }
}

impl Drop for Code {
    fn drop(&mut self) {
        if let Some(module) = self.0.take() {
            // SAFETY: whoever has addresses of it, functions or marches, has it too
            unsafe { module.free_memory() };
        }
    }
}

/// What functions are compiled with.
struct Compiler {
    code: Code,
    context: cranelift_codegen::Context,
    builder: FunctionBuilderContext,
    outside: HashMap<Outside, FuncId>,
    /// How many members' numbers are side by side.
    members: usize,
    /// Whether something is called that there is not.
    is_missing: bool,
}

impl Compiler {
    fn new(processor: OwnedTargetIsa, members: usize) -> Self {
        let mut builder = JITBuilder::with_isa(processor, default_libcall_names());
        Outside::all()
            .filter_map(Outside::symbol)
            .for_each(|(name, address)| _ = builder.symbol(name, address));
        let module = JITModule::new(builder);
        let context = module.make_context();
        Self {
            code: Code(Some(module)),
            context,
            builder: FunctionBuilderContext::new(),
            outside: HashMap::new(),
            members,
            is_missing: false,
        }
    }

    /// A function of an address.
    fn define(&mut self, places: usize, body: impl FnOnce(&mut Emitter<'_, '_>)) -> Option<FuncId> {
        let Self { code, context, builder, outside, members, is_missing } = self;
        let module = code.module();
        let config = module.target_config();
        let pointer = config.pointer_type();
        let mut signature = Signature::new(config.default_call_conv);
        signature.params.push(AbiParam::new(pointer));
        let id = module.declare_anonymous_function(&signature).ok()?;
        context.func.signature = signature;
        {
            let mut imported = HashMap::new();
            let mut find = |function: Outside, within: &mut ir::Function| {
                if let Some(known) = imported.get(&function) {
                    return Some(*known);
                }
                let id = match outside.get(&function) {
                    Some(id) => *id,
                    None => {
                        let signature = function.signature(config.default_call_conv, pointer);
                        let (name, _) = function.symbol()?;
                        let id = module.declare_function(name, Linkage::Import, &signature).ok()?;
                        outside.insert(function, id);
                        id
                    }
                };
                let found = module.declare_func_in_func(id, within);
                imported.insert(function, found);
                Some(found)
            };
            let builder = FunctionBuilder::new(&mut context.func, builder);
            let mut emitter = Emitter::new(builder, &mut find, pointer, *members, places);
            let block = emitter.builder.create_block();
            emitter.builder.append_block_params_for_function_params(block);
            emitter.builder.switch_to_block(block);
            emitter.frame = emitter.builder.block_params(block)[0];
            body(&mut emitter);
            emitter.builder.seal_all_blocks();
            *is_missing |= emitter.is_missing;
            emitter.builder.finalize(config);
        }
        let defined = module.define_function(id, context);
        module.clear_context(context);
        defined.ok().map(|()| id)
    }

    fn function(
        &mut self,
        module: &Module<StepRole>,
        function: &Function<StepRole>,
        layout: &Layout,
    ) -> Option<FuncId> {
        let places = InStep { layout, module, function };
        self.define(module.values.places(), |emitter| emitter.whole(function, &places))
    }
}
