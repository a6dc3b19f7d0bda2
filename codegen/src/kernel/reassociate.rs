//! The order in which sums are added, their signs, and where a product is added in one operation: the last decisions
//! that bear on roundoff.

use crate::program::Term;

/// The most addends in one line.
const LONGEST_SUM: usize = 8;

/// The term with sums that begin with an addend that is not subtracted, and products added as they are formed; `part`
/// takes the beginnings of long sums into lines of their own. `associate`: sums within sums are added together.
pub(super) fn reassociated(term: Term, associate: bool, part: &mut impl FnMut(Term) -> Term) -> Term {
    in_lines(signed(term, associate), part)
}

/// Sums whose first addend is not subtracted.
fn signed(term: Term, associate: bool) -> Term {
    match term.map(|operand| signed(operand, associate)) {
        Term::Negative(x) => match *x {
            // −(a − b) reads b − a
            Term::Sum(mut addends) if addends.len() == 2 && addends[1].0 => {
                addends.reverse();
                addends[0].0 = false;
                addends[1].0 = true;
                Term::Sum(addends)
            }
            x => Term::Negative(Box::new(x)),
        },
        Term::Sum(addends) => sum(addends, associate),
        term => term,
    }
}

fn sum(mut addends: Vec<(bool, Term)>, associate: bool) -> Term {
    if associate {
        let has_constant = addends.iter().any(|(_, term)| matches!(term, Term::Number(_)));
        addends = if has_constant { balanced(addends) } else { flat(addends) };
    }
    match addends.iter().position(|(negative, _)| !negative) {
        Some(first) => {
            // a − b, not −b + a
            let leading = addends.remove(first);
            addends.insert(0, leading);
            Term::Sum(addends)
        }
        None => {
            addends.iter_mut().for_each(|(negative, _)| *negative = false);
            let sum = if addends.len() == 1 { addends.remove(0).1 } else { Term::Sum(addends) };
            Term::Negative(Box::new(sum))
        }
    }
}

/// A sum of sums as one, in which every product can be added as it is formed. Its roundings are those of the largest
/// addend, once for each of the others: next to an unknown that is a small change itself they make no difference, in
/// the state that it changes they would.
fn flat(addends: Vec<(bool, Term)>) -> Vec<(bool, Term)> {
    let mut flat = Vec::new();
    for (negative, addend) in addends {
        match addend {
            Term::Sum(inner) => flat.extend(inner.into_iter().map(|(sign, term)| (sign ^ negative, term))),
            other => flat.push((negative, other)),
        }
    }
    flat
}

/// The fewest addends of which two sums are made that do not wait for one another.
const LONG_SUM: usize = 4;

/// A constant and at least three small numbers as two sums that do not wait for one another, which costs one rounding
/// more; fewer keep together.
fn balanced(addends: Vec<(bool, Term)>) -> Vec<(bool, Term)> {
    let mut all = flat(addends.clone());
    if all.len() < LONG_SUM || all.iter().any(|(negative, _)| *negative) {
        return addends;
    }
    all.sort_by_key(|(_, term)| !matches!(term, Term::Number(_)));
    let rest = all.split_off(all.len() / 2);
    vec![(false, Term::Sum(all)), (false, Term::Sum(rest))]
}

/// Products that are added in one operation to what stands before them.
fn contracted(term: Term) -> Term {
    match term {
        Term::Sum(addends) => added(addends, &mut |sum| sum),
        term => term.map(contracted),
    }
}

/// The same of a whole line: a sum that begins with a sum is one with it, and `part` makes something shorter of the
/// beginning of a long one.
fn in_lines(term: Term, part: &mut impl FnMut(Term) -> Term) -> Term {
    match term {
        Term::Negative(x) => Term::Negative(Box::new(in_lines(*x, part))),
        Term::Sum(mut addends) => {
            while let Term::Sum(_) = addends[0].1
                && let (negative, Term::Sum(first)) = addends.remove(0)
            {
                debug_assert!(!negative, "the first addend is not subtracted");
                addends.splice(0..0, first);
            }
            added(addends, part)
        }
        term => contracted(term),
    }
}

/// The sum from left to right, each product added as it is formed.
fn added(addends: Vec<(bool, Term)>, part: &mut impl FnMut(Term) -> Term) -> Term {
    let mut addends = addends.into_iter().map(|(negative, addend)| (negative, contracted(addend)));
    let Some((_, first)) = addends.next() else { return Term::Number(0.into()) };
    // whether the sum so far is one of this fold's, which goes on
    let mut open = false;
    addends.enumerate().fold(first, |mut sum, (place, (negative, addend))| {
        if place > 0 && place % LONGEST_SUM == 0 {
            sum = part(sum);
            open = false;
        }
        match (addend, sum) {
            (Term::Product(mut factors), sum) if factors.len() > 1 => {
                open = false;
                let last = factors.pop().unwrap_or_else(|| Term::Number(1.into()));
                let others = if factors.len() == 1 { factors.remove(0) } else { Term::Product(factors) };
                let (a, b, addend) = (Box::new(others), Box::new(last), Box::new(sum));
                Term::MulAdd { negative, a, b, addend }
            }
            (addend, Term::Sum(mut addends)) if open => {
                addends.push((negative, addend));
                Term::Sum(addends)
            }
            (addend, sum) => {
                open = true;
                Term::Sum(vec![(false, sum), (negative, addend)])
            }
        }
    })
}
