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
use std::sync::{Arc, LazyLock, OnceLock};

use coadjoint::erased::dynamic::{LANES, Layout, March, Marching, StepFunction, row_length};
use coadjoint_codegen::program::{Function, Module, Program, StepRole};
use cranelift_codegen::ir::{self, AbiParam, Signature};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module as _, ModuleResult, default_libcall_names};

use self::emit::Emitter;
use self::outside::Outside;
use crate::STACK;
use crate::definition::{FUNCTIONS, InStep};

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
        ("enable_verifier", if std::env::var_os("JITVERIFY").is_some() { "true" } else { "false" }),
    ];
    options.iter().try_for_each(|(name, value)| flags.set(name, value)).ok()?;
    cranelift_native::builder().ok()?.finish(settings::Flags::new(flags)).ok()
});

/// Whether machine code can be made.
pub(crate) fn is_here() -> bool {
    PROCESSOR.is_some()
}

/// A step's functions, compiled when they are needed.
pub(crate) struct Machine {
    program: Arc<Program>,
    /// Which of its steps it is.
    place: usize,
    layout: Layout,
    /// How many numbers a frame has.
    frame: usize,
    alone: OnceLock<Option<Arc<Compiled>>>,
    wide: OnceLock<Option<Arc<Compiled>>>,
}

/// What is compiled.
struct Compiled {
    functions: [Option<Call>; 8],
    march: Option<unsafe extern "C" fn(*mut Marching)>,
    _code: Code,
}

impl Machine {
    pub(crate) fn new(program: Arc<Program>, place: usize, layout: Layout, frame: usize) -> Self {
        Self { program, place, layout, frame, alone: OnceLock::new(), wide: OnceLock::new() }
    }

    fn compiled(&self, wide: bool) -> Option<&Arc<Compiled>> {
        let of = if wide { &self.wide } else { &self.alone };
        let compiled = of.get_or_init(|| {
            // with as much stack as what derived it
            std::thread::scope(|scope| {
                let thread = std::thread::Builder::new().name("machine code".to_owned()).stack_size(STACK);
                let thread = thread.spawn_scoped(scope, || self.compile(wide).ok().flatten());
                thread.ok()?.join().ok()?.map(Arc::new)
            })
        });
        compiled.as_ref()
    }

    fn compile(&self, wide: bool) -> ModuleResult<Option<Compiled>> {
        let (Some(processor), Some(step)) = (&*PROCESSOR, self.program.steps.get(self.place)) else { return Ok(None) };
        let mut compiler = Compiler::new(processor.clone(), wide);
        let module = &step.module;
        let mut ids = [None; 8];
        for (id, (_, role)) in ids.iter_mut().zip(FUNCTIONS) {
            if let Some(function) = module.function(role) {
                *id = Some(compiler.function(module, function, &self.layout)?);
            }
        }
        let has_march = !wide && march::has_path(step, &self.layout);
        let march = if has_march { Some(march::defined(&mut compiler, &[(step, &self.layout)])?) } else { None };
        if compiler.is_missing {
            return Ok(None);
        }
        compiler.code.module().finalize_definitions()?;
        let code = compiler.code;
        // SAFETY: they were compiled with these signatures
        let functions = ids.map(|id| id.map(|id| unsafe { std::mem::transmute::<*const u8, Call>(code.address(id)) }));
        let march = march.map(|id| unsafe {
            std::mem::transmute::<*const u8, unsafe extern "C" fn(*mut Marching)>(code.address(id))
        });
        Ok(Some(Compiled { functions, march, _code: code }))
    }

    /// Calls a function on a frame, if there is code for it.
    pub(crate) fn call(&self, function: StepFunction, frame: &mut [f64]) -> bool {
        let Some(compiled) = self.compiled(false).filter(|_| frame.len() == self.frame) else { return false };
        if let Some(function) = compiled.functions[function as usize] {
            // SAFETY: it reads and writes places of a frame of this length
            unsafe { function(frame.as_mut_ptr()) };
        }
        true
    }

    /// The same on frames side by side, two at a time.
    pub(crate) fn call_wide(&self, function: StepFunction, frame: &mut [[f64; LANES]]) -> bool {
        let Some(compiled) = self.compiled(true).filter(|_| frame.len() == self.frame) else { return false };
        if let Some(function) = compiled.functions[function as usize] {
            let first: *mut f64 = frame.as_mut_ptr().cast();
            for pair in 0..LANES / 2 {
                // SAFETY: it reads and writes two lanes of each place of a frame of this length
                unsafe { function(first.add(2 * pair)) };
            }
        }
        true
    }

    /// What takes many steps at a time.
    pub(crate) fn march(&self) -> Option<March> {
        let compiled = self.compiled(false)?;
        let row = row_length(self.layout.unknown.len());
        // SAFETY: the code is part of the owner, and goes by the layout of such a frame and such rows
        Some(unsafe { March::new(compiled.march?, vec![[self.frame, row]], compiled.clone()) })
    }
}

/// Code in memory, which is freed with it.
struct Code(Option<JITModule>);

// SAFETY: what is in there is not written to once the functions are finished, and until then it has one owner
unsafe impl Send for Code {}
// SAFETY: as above; through a reference there is nothing to be had but addresses
unsafe impl Sync for Code {}

impl Code {
    fn module(&mut self) -> &mut JITModule {
        self.0.as_mut().expect("there is one until this is dropped")
    }

    fn address(&self, id: FuncId) -> *const u8 {
        self.0.as_ref().map_or(std::ptr::null(), |module| module.get_finalized_function(id))
    }
}

impl Drop for Code {
    fn drop(&mut self) {
        if let Some(module) = self.0.take() {
            // SAFETY: who could call it has it no longer: `Compiled` has its addresses, and is what marches keep
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
    wide: bool,
    /// Whether something is called that there is not.
    is_missing: bool,
}

impl Compiler {
    fn new(processor: OwnedTargetIsa, wide: bool) -> Self {
        let mut builder = JITBuilder::with_isa(processor, default_libcall_names());
        Outside::all().filter_map(Outside::symbol).for_each(|(name, address)| _ = builder.symbol(name, address));
        let module = JITModule::new(builder);
        let context = module.make_context();
        Self {
            code: Code(Some(module)),
            context,
            builder: FunctionBuilderContext::new(),
            outside: HashMap::new(),
            wide,
            is_missing: false,
        }
    }

    /// A function of an address.
    fn define(&mut self, places: usize, body: impl FnOnce(&mut Emitter<'_, '_>)) -> ModuleResult<FuncId> {
        let Self { code, context, builder, outside, wide, is_missing } = self;
        let module = code.module();
        let config = module.target_config();
        let pointer = config.pointer_type();
        let mut signature = Signature::new(config.default_call_conv);
        signature.params.push(AbiParam::new(pointer));
        let id = module.declare_anonymous_function(&signature)?;
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
            let mut emitter = Emitter::new(builder, &mut find, pointer, *wide, places);
            let block = emitter.builder.create_block();
            emitter.builder.append_block_params_for_function_params(block);
            emitter.builder.switch_to_block(block);
            emitter.frame = emitter.builder.block_params(block)[0];
            body(&mut emitter);
            emitter.builder.seal_all_blocks();
            *is_missing |= emitter.is_missing;
            emitter.builder.finalize(config);
        }
        let dump = std::env::var_os("JITDUMP").is_some();
        context.set_disasm(dump);
        let defined = module.define_function(id, context);
        if dump { eprintln!("=== {id}\n{}", context.compiled_code().unwrap().vcode.as_ref().unwrap()); }
        module.clear_context(context);
        defined.map(|()| id)
    }

    fn function(
        &mut self,
        module: &Module<StepRole>,
        function: &Function<StepRole>,
        layout: &Layout,
    ) -> ModuleResult<FuncId> {
        let places = InStep { layout, module, function };
        self.define(module.values.places(), |emitter| emitter.whole(function, &places))
    }
}
