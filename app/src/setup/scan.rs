//! `--scan name=from:to:count`: the values that a parameter, a number of the initial state, a control or the step takes,
//! one after the other.

use super::assign::driven;
use super::names::{Name, Names, Part, named, numbers};
use crate::catalogue::{Entry, Input, component_name};
use crate::error::SetupError;

/// No more runs than these: a table that nobody reads, and memory for it.
const MOST: usize = 1_000_000;

/// The name of the step, unless a quantity of the system has it.
const STEP: &str = "step";

/// A number and the values that it takes in a scan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scan {
    /// The name of a number.
    pub(crate) name: String,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// Its values.
    pub(crate) values: Vec<f64>,
    /// Whether it is the step.
    pub(crate) is_step: bool,
}

impl Scan {
    /// Reads `weight=1:10:20`, twenty values from 1 to 10, or `weight=1,2,5`.
    ///
    /// # Errors
    /// If the name is not that of one number, or that of a control that a table drives, or the values are no finite numbers.
    pub(crate) fn parse(entry: &Entry, input: Option<&Input>, text: &str) -> Result<Self, SetupError> {
        let wrong = |what: &str| SetupError::new(format!("`--scan {text}`: {what}"));
        let form = "write `name=from:to:count`, as in `weight=1:10:20`, or `name=1,2,5`";
        let (name, range) = text.split_once('=').ok_or_else(|| wrong(form))?;
        let (name, range) = (name.trim(), range.trim());
        let target = match named(entry, Names::ALL, name) {
            Err(_) if name == STEP => None,
            target => Some(target?),
        };
        let is_driven = |target: &&Name| {
            target.part == Part::Controls && input.is_some_and(|input| input.drives(target.slots.start))
        };
        if let (Some(target), Some(input)) = (target.as_ref().filter(is_driven), input) {
            return Err(driven(&target.name, input));
        }
        if let Some(target) = target.as_ref().filter(|target| target.slots.len() != 1) {
            let component = component_name(target.quantity, target.quantity.components[0]);
            return Err(wrong(&format!("one number is scanned at a time, as in `{component}=…`")));
        }
        let values = match range.split(':').collect::<Vec<_>>()[..] {
            [list] => numbers(text, list)?,
            [from, to, count] => {
                let ends = numbers(text, &format!("{from},{to}"))?;
                let count = count.trim().parse::<usize>().map_err(|_| wrong(form))?;
                if count == 0 || count > MOST {
                    return Err(wrong(&format!("the count must be from 1 to {MOST}, got {count}")));
                }
                evenly(ends[0], ends[1], count)
            }
            _ => return Err(wrong(form)),
        };
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(wrong(&format!("values must be finite, got {value}")));
        }
        let (is_step, unit) = target.map_or((true, "s"), |target| (false, target.unit));
        Ok(Self { name: name.to_owned(), unit, values, is_step })
    }

    /// All combinations of one or two scans, the last one varying fastest.
    ///
    /// # Errors
    /// If there are more than two, two of one name, or too many combinations.
    pub(crate) fn grid(scans: &[Scan]) -> Result<Vec<Vec<f64>>, SetupError> {
        if scans.len() > 2 {
            return Err(SetupError::new(format!("at most two numbers are scanned, got {}", scans.len())));
        }
        if let [first, second] = scans
            && first.name == second.name
        {
            return Err(SetupError::new(format!("`{}` is scanned twice", first.name)));
        }
        if scans.iter().fold(1, |count: usize, scan| count.saturating_mul(scan.values.len())) > MOST {
            return Err(SetupError::new(format!("a scan makes at most {MOST} runs")));
        }
        let mut points = vec![Vec::new()];
        for scan in scans {
            let longer = |point: &Vec<f64>| {
                let longer = |&value: &f64| [&point[..], &[value]].concat();
                scan.values.iter().map(longer).collect::<Vec<_>>()
            };
            points = points.iter().flat_map(longer).collect();
        }
        Ok(points)
    }
}

/// So many numbers from one to another, both included.
fn evenly(from: f64, to: f64, count: usize) -> Vec<f64> {
    let last = (count - 1).max(1);
    let value =
        |i: usize| if i > 0 && i == last { to } else { from + (to - from) * (i as f64 / last as f64) };
    (0..count).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    fn scan(text: &str) -> Result<Vec<f64>, String> {
        let top = catalogue().find("heavy_top").expect("it is there");
        Scan::parse(top, None, text).map(|scan| scan.values).map_err(|error| error.to_string())
    }

    #[test]
    fn ranges_and_lists_are_read() {
        assert_eq!(scan("weight=1:10:4"), Ok(vec![1.0, 4.0, 7.0, 10.0]));
        assert_eq!(scan("weight=10:1:2"), Ok(vec![10.0, 1.0]));
        assert_eq!(scan("weight=3:5:1"), Ok(vec![3.0]));
        assert_eq!(scan(" momentum_z = 1, 2,5"), Ok(vec![1.0, 2.0, 5.0]));
        // both ends exactly
        let values = scan("chi_x=0.1:0.7:7").expect("valid");
        assert_eq!((values[0], values[6]), (0.1, 0.7));
    }

    #[test]
    fn mistakes_are_explained() {
        for (text, expected) in [
            ("weight", "write `name=from:to:count`"),
            ("wieght=1:2:3", "did you mean `weight`?"),
            ("chi=1:2:3", "as in `chi_x=…`"),
            ("weight=1:2", "write `name=from:to:count`"),
            ("weight=1:2:0", "the count must be from 1"),
            ("weight=1:2:2000000", "to 1000000"),
            ("weight=1:2:x", "write `name=from:to:count`"),
            ("weight=a:2:3", "`a` is not a number"),
            ("weight=1,inf", "must be finite"),
        ] {
            let message = scan(text).expect_err(text);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn two_scans_make_a_grid() {
        let scan = |name: &str, values: &[f64]| Scan {
            name: name.to_owned(),
            unit: "",
            values: values.to_vec(),
            is_step: false,
        };
        let (a, b) = (scan("a", &[1.0, 2.0]), scan("b", &[3.0, 4.0, 5.0]));
        let points = Scan::grid(&[a.clone(), b.clone()]).expect("valid");
        assert_eq!(points.len(), 6);
        assert_eq!((&points[0], &points[1], &points[5]), (&vec![1.0, 3.0], &vec![1.0, 4.0], &vec![2.0, 5.0]));
        assert!(Scan::grid(&[a.clone(), a.clone()]).is_err());
        assert!(Scan::grid(&[a.clone(), b, scan("c", &[1.0])]).is_err());
        let many = scan("many", &vec![0.0; 1001]);
        assert!(Scan::grid(&[many.clone(), Scan { name: "other".to_owned(), ..many }]).is_err());
    }
}
