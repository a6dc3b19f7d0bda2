//! Blocks with `let`.

use syn::ext::IdentExt;
use syn::{Block, ExprBlock, Local, Pat, Stmt};

use super::lowering::Lowering;
use super::value::Value;

impl<'a> Lowering<'a, '_> {
    pub(super) fn block_expression(&mut self, block: &ExprBlock) -> Option<Value<'a>> {
        if let Some(attribute) = block.attrs.first() {
            return self.fail(attribute, "attributes are not supported in expressions");
        }
        if let Some(label) = &block.label {
            return self.unsupported(label, "a label");
        }
        self.scoped_block(&block.block)
    }

    /// A block with variables of its own.
    pub(super) fn scoped_block(&mut self, block: &Block) -> Option<Value<'a>> {
        let outside = self.locals.len();
        let value = self.block(block);
        self.locals.truncate(outside);
        value
    }

    fn block(&mut self, block: &Block) -> Option<Value<'a>> {
        let Some((last, statements)) = block.stmts.split_last() else {
            return self.fail(block, "this block is empty; it must end with a value");
        };
        for statement in statements {
            self.statement(statement);
        }
        match last {
            Stmt::Expr(value, None) => self.lower(value),
            Stmt::Macro(call) if call.semi_token.is_none() => self.macro_call(&call.mac),
            Stmt::Expr(value, Some(semicolon)) => {
                self.lower(value);
                self.fail(semicolon, "the block must end with a value; leave out this semicolon")
            }
            _ => {
                self.statement(last);
                self.fail(last, "the block must end with a value after this")
            }
        }
    }

    fn statement(&mut self, statement: &Stmt) {
        match statement {
            Stmt::Local(local) => self.binding(local),
            Stmt::Expr(expr, _) => {
                // what is wrong within is worth saying first
                if self.lower(expr).is_some() {
                    self.diagnostics.push(expr, "this value is not used; give it a name with `let`");
                }
            }
            Stmt::Item(item) => {
                self.diagnostics.push(item, "items are not supported in expressions; write `let name = …;`");
            }
            Stmt::Macro(call) => {
                self.diagnostics.push(call, "this has no value; leave it out");
            }
        }
    }

    /// `let pattern = value;` rustc checks the type, if one is written.
    fn binding(&mut self, local: &Local) {
        if let Some(attribute) = local.attrs.first() {
            self.diagnostics.push(attribute, "attributes are not supported in expressions");
        }
        let value = match &local.init {
            Some(init) => {
                if let Some((otherwise, _)) = &init.diverge {
                    self.diagnostics.push(otherwise, "`let … else` is not supported here");
                }
                self.lower(&init.expr)
            }
            None => self.fail(local, "this variable needs a value; write `let name = …;`"),
        };
        self.bind(&local.pat, value);
    }

    /// Gives names to a value, or to its parts.
    pub(super) fn bind(&mut self, pattern: &Pat, value: Option<Value<'a>>) {
        match pattern {
            Pat::Ident(name) if name.subpat.is_none() => {
                self.locals.push((name.ident.unraw().to_string(), value))
            }
            Pat::Type(typed) => self.bind(&typed.pat, value),
            Pat::Paren(inner) => self.bind(&inner.pat, value),
            // values and references to them are the same to mathematics
            Pat::Reference(inner) => self.bind(&inner.pat, value),
            Pat::Wild(_) => {}
            Pat::Tuple(tuple) => {
                let values = match value {
                    Some(Value::Tuple(values)) if values.len() == tuple.elems.len() => values,
                    Some(other) => {
                        let message = format!("{} cannot be taken apart like this", other.describe());
                        self.diagnostics.push(tuple, message);
                        Vec::new()
                    }
                    None => Vec::new(),
                };
                let mut values = values.into_iter();
                tuple.elems.iter().for_each(|pattern| self.bind(pattern, values.next()));
            }
            _ => {
                let message = "a pattern is a name, or names in parentheses: `let (s, c) = …;`";
                self.diagnostics.push(pattern, message);
            }
        }
    }
}
