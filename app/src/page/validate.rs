//! Whether data make a page, and where they do not.

use thiserror::Error;

use super::format::{Body, FORMAT, Frame, MOST_MOMENTS, MOST_THINGS, Page, Run, Track};

/// Data that make no page.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PageError {
    /// They are no such JSON.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Something in them cannot be.
    #[error("`{place}`: {reason}")]
    Value {
        /// Where: `runs[0].bodies[1].rotation[2]`.
        place: String,
        /// Why.
        reason: String,
    },
}

fn wrong(place: &str, reason: impl Into<String>) -> Result<(), PageError> {
    Err(PageError::Value { place: place.to_owned(), reason: reason.into() })
}

/// Says what is wrong with a place, unless it is so.
fn expect(is_so: bool, place: &str, reason: impl FnOnce() -> String) -> Result<(), PageError> {
    if is_so { Ok(()) } else { wrong(place, reason()) }
}

/// A quaternion's length may be off 1 by so much: it is normalised. Farther off it is taken for a mistake.
const NEARLY_UNIT: f64 = 0.1;

impl Page {
    /// The page that a JSON text describes. Quaternions that are not quite of unit length are normalised.
    ///
    /// # Errors
    /// If it is none; the error names the place.
    pub fn from_json(text: &str) -> Result<Self, PageError> {
        let mut page: Self = serde_json::from_str(text)?;
        page.check()?;
        Ok(page)
    }

    /// Checks everything that the types do not say, and normalises quaternions.
    ///
    /// # Errors
    /// If something cannot be; the error names the place.
    pub fn check(&mut self) -> Result<(), PageError> {
        let format = || format!("expected \"{FORMAT}\", got {:?}", self.format);
        expect(self.format == FORMAT, "format", format)?;
        moments("time", &self.time)?;
        vector("space", self.space.ground.iter().chain(self.space.look.iter().flatten()))?;
        each("runs", &mut self.runs, |place, run| {
            if run.time.is_empty() && self.time.is_empty() {
                return wrong(place, "has no moments: give `time`, here or for all runs");
            }
            let count = if run.time.is_empty() { self.time.len() } else { run.time.len() };
            check_run(place, run, count)
        })
    }
}

/// Checks each of some things, of which there are few.
fn each<T>(
    place: &str,
    things: &mut [T],
    mut check: impl FnMut(&str, &mut T) -> Result<(), PageError>,
) -> Result<(), PageError> {
    let count = things.len();
    let few = || format!("has {count} entries; at most {MOST_THINGS} can be shown");
    expect(count <= MOST_THINGS, place, few)?;
    things.iter_mut().enumerate().try_for_each(|(k, thing)| check(&format!("{place}[{k}]"), thing))
}

fn check_run(place: &str, run: &mut Run, moment_count: usize) -> Result<(), PageError> {
    moments(&format!("{place}.time"), &run.time)?;
    for (name, number) in [("turn", run.turn), ("rate", run.rate)] {
        let is_angle = number.is_none_or(|number| number.is_finite() && number >= 0.0);
        expect(is_angle, &format!("{place}.{name}"), || "must be finite and not negative".to_owned())?;
    }
    let bodies = run.bodies.len();
    each(&format!("{place}.bodies"), &mut run.bodies, |place, body| check_body(place, body, moment_count))?;
    each(&format!("{place}.arrows"), &mut run.arrows, |place, arrow| {
        known(place, arrow.body, bodies)?;
        colour(place, arrow.colour.as_deref())?;
        vector(&format!("{place}.from"), arrow.from.iter().flatten())?;
        if arrow.frame == Frame::Body && arrow.body.is_none() {
            return wrong(&format!("{place}.frame"), "is that of a body; say which by `body`");
        }
        let place = format!("{place}.vector");
        match &mut arrow.vector {
            Some(track) => check_track::<3>(&place, track, moment_count, |_, _| Ok(())),
            None => wrong(&place, "is missing"),
        }
    })?;
    each(&format!("{place}.links"), &mut run.links, |place, link| {
        [("from", &link.from), ("to", &link.to)].into_iter().try_for_each(|(name, end)| {
            let place = format!("{place}.{name}");
            known(&place, end.body, bodies)?;
            vector(&place, &end.at)
        })
    })?;
    each(&format!("{place}.plots"), &mut run.plots, |place, plot| {
        each(&format!("{place}.series"), &mut plot.series, |place, series| {
            colour(place, series.colour.as_deref())?;
            as_many(&format!("{place}.values"), series.values.len(), moment_count)?;
            vector(&format!("{place}.values"), &series.values)
        })
    })
}

fn check_body(place: &str, body: &mut Body<Track>, moment_count: usize) -> Result<(), PageError> {
    colour(place, body.colour.as_deref())?;
    if let Some(rotation) = &mut body.rotation {
        check_track::<4>(&format!("{place}.rotation"), rotation, moment_count, normalise)?;
    }
    if let Some(position) = &mut body.position {
        check_track::<3>(&format!("{place}.position"), position, moment_count, |_, _| Ok(()))?;
    }
    if let Some(solid) = &mut body.shape {
        let place = format!("{place}.shape");
        vector(&format!("{place}.centre"), &solid.centre)?;
        vector(&format!("{place}.rotation"), &solid.rotation)?;
        normalise(&format!("{place}.rotation"), &mut solid.rotation)?;
        let is_solid = solid.shape.lengths().iter().all(|length| length.is_finite() && *length > 0.0);
        expect(is_solid, &place, || "all its lengths must be finite and positive".to_owned())?;
    }
    Ok(())
}

/// Moments that all lie ahead of each other, forwards or backwards in time.
fn moments(place: &str, time: &[f64]) -> Result<(), PageError> {
    let count = time.len();
    let few = || format!("has {count} moments; at most {MOST_MOMENTS} can be shown");
    expect(count <= MOST_MOMENTS, place, few)?;
    vector(place, time)?;
    let backwards = time.last() < time.first();
    let wrong_way =
        time.windows(2).position(|pair| if backwards { pair[1] >= pair[0] } else { pair[1] <= pair[0] });
    wrong_way.map_or(Ok(()), |k| {
        wrong(&format!("{place}[{}]", k + 1), "moments must follow each other in one direction")
    })
}

/// Checks a track of `N` numbers, and each of them by what is to be done `then`.
fn check_track<const N: usize>(
    place: &str,
    track: &mut Track,
    moment_count: usize,
    then: fn(&str, &mut [f64]) -> Result<(), PageError>,
) -> Result<(), PageError> {
    let check = |place: &str, v: &mut Vec<f64>| {
        expect(v.len() == N, place, || format!("expected {N} numbers, got {}", v.len()))?;
        vector(place, &*v)?;
        then(place, v)
    };
    match track {
        Track::Constant(one) => check(place, one),
        Track::Path(path) => {
            as_many(place, path.len(), moment_count)?;
            path.iter_mut().enumerate().try_for_each(|(k, v)| check(&format!("{place}[{k}]"), v))
        }
    }
}

fn normalise(place: &str, quaternion: &mut [f64]) -> Result<(), PageError> {
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    let other = || format!("a rotation is a quaternion [w, x, y, z] of length 1; this one has {length}");
    expect((length - 1.0).abs() <= NEARLY_UNIT, place, other)?;
    quaternion.iter_mut().for_each(|x| *x /= length);
    Ok(())
}

fn vector<'a>(place: &str, numbers: impl IntoIterator<Item = &'a f64>) -> Result<(), PageError> {
    let infinite = numbers.into_iter().find(|number| !number.is_finite());
    infinite.map_or(Ok(()), |number| wrong(place, format!("{number} is not finite")))
}

fn as_many(place: &str, count: usize, moment_count: usize) -> Result<(), PageError> {
    expect(count == moment_count, place, || format!("has {count} entries for {moment_count} moments"))
}

fn known(place: &str, body: Option<usize>, bodies: usize) -> Result<(), PageError> {
    let Some(body) = body else { return Ok(()) };
    let other = || format!("there is no body {body}; there are {bodies}, counted from 0");
    expect(body < bodies, &format!("{place}.body"), other)
}

fn colour(place: &str, colour: Option<&str>) -> Result<(), PageError> {
    const COLOURS: [&str; 11] =
        ["solid", "second", "planet", "ink", "c0", "c1", "c2", "c3", "c4", "c5", "c6"];
    let Some(colour) = colour else { return Ok(()) };
    let other = || format!("expected one of {}, got {colour:?}", COLOURS.join(", "));
    expect(COLOURS.contains(&colour), &format!("{place}.colour"), other)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = r#""time": [0, 1]"#;

    fn rejected(rest: &str) -> String {
        let text = format!(r#"{{"format": "{FORMAT}", {rest}}}"#);
        Page::from_json(&text).expect_err(&text).to_string()
    }

    #[test]
    fn the_least_page_is_one() {
        let text = format!(
            r#"{{"format": "{FORMAT}", {TWO}, "runs": [{{"bodies": [{{"rotation": [[1, 0, 0, 0], [0.99, 0, 0, 0]]}}]}}]}}"#
        );
        let page = Page::from_json(&text).expect("valid");
        let Some(Track::Path(path)) = &page.runs[0].bodies[0].rotation else { panic!("a path") };
        assert_eq!(path[1], [1.0, 0.0, 0.0, 0.0], "normalised");
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        for (rest, place, reason) in [
            (r#""runs": [{}]"#, "`runs[0]`", "no moments"),
            (r#""time": [0, 1, 1]"#, "`time[2]`", "one direction"),
            (r#""time": [0, 2, 1]"#, "`time[2]`", "one direction"),
            (
                &format!(r#"{TWO}, "runs": [{{"bodies": [{{"rotation": [[1,0,0,0]]}}]}}]"#),
                "`runs[0].bodies[0].rotation`",
                "1 entries for 2 moments",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"bodies": [{{"rotation": [1,0,0]}}]}}]"#),
                "`runs[0].bodies[0].rotation`",
                "expected 4 numbers, got 3",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"bodies": [{{"rotation": [[1,0,0,0],[2,0,0,0]]}}]}}]"#),
                "`runs[0].bodies[0].rotation[1]`",
                "this one has 2",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"arrows": [{{"vector": [1,0,0], "body": 3}}]}}]"#),
                "`runs[0].arrows[0].body`",
                "no body 3",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"arrows": [{{"vector": [1,0,0], "frame": "body"}}]}}]"#),
                "`runs[0].arrows[0].frame`",
                "say which",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"plots": [{{"series": [{{"values": [1]}}]}}]}}]"#),
                "`runs[0].plots[0].series[0].values`",
                "1 entries for 2",
            ),
            (
                &format!(
                    r#"{TWO}, "runs": [{{"bodies": [{{"shape": {{"kind": "sphere", "radius": -1}}}}]}}]"#
                ),
                "`runs[0].bodies[0].shape`",
                "positive",
            ),
            (
                &format!(r#"{TWO}, "runs": [{{"bodies": [{{"colour": "red"}}]}}]"#),
                "`runs[0].bodies[0].colour`",
                "expected one of",
            ),
            (&format!(r#"{TWO}, "runs": [{{"bodies": [{{"roation": []}}]}}]"#), "roation", "expected one of"),
            (
                &format!(r#"{TWO}, "runs": [{{"bodies": [{{"position": [[0,0,null],[0,0,0]]}}]}}]"#),
                "line 1",
                "list of vectors of numbers",
            ),
            (r#""time": 1e999"#, "line 1", "out of range"),
        ] {
            let message = rejected(rest);
            assert!(message.contains(place) && message.contains(reason), "{rest}: {message}");
        }
        assert!(Page::from_json("{}").expect_err("no format").to_string().contains("`format`"));
    }

    #[test]
    fn a_text_that_is_cut_off_is_no_page() {
        let text = format!(
            r#"{{"format": "{FORMAT}", {TWO}, "runs": [{{"bodies": [{{"position": [1, 2, 3]}}]}}]}}"#
        );
        assert!(Page::from_json(&text).is_ok());
        for end in 0..text.len() {
            assert!(Page::from_json(&text[..end]).is_err(), "{}", &text[..end]);
        }
    }

    #[test]
    fn the_examples_of_the_documentation_are_valid() {
        let text = include_str!("../../PAGE_FORMAT.md");
        let blocks: Vec<&str> =
            text.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
        let [page, shapes] = blocks.as_slice() else { panic!("{} blocks", blocks.len()) };
        assert_eq!(Page::from_json(page).expect("valid").runs.len(), 1);
        for shape in shapes.lines() {
            let solid: crate::shape::Solid = serde_json::from_str(shape).expect(shape);
            assert!(solid.shape.lengths().iter().all(|length| *length > 0.0), "{shape}");
        }
        assert_eq!(shapes.lines().count(), 7);
    }
}
