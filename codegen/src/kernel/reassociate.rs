//! The order in which sums are added, their signs, and where a product is added in one operation: the last decisions
//! that bear on roundoff.

use crate::program::Term;

/// The term with sums that begin with an addend that is not subtracted, and products added as they are formed.
/// `associate`: sums within sums are added together.
pub(super) fn reassociated(term: Term, associate: bool) -> Term {
    contracted(signed(term, associate))
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
    let addends = match term.map(contracted) {
        Term::Sum(addends) => addends,
        term => return term,
    };
    let mut addends = addends.into_iter();
    let Some((_, first)) = addends.next() else { return Term::Number(0.into()) };
    // whether the sum so far is one of this fold's, which goes on
    let mut open = false;
    addends.fold(first, |sum, (negative, addend)| match (addend, sum) {
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
    })
}
