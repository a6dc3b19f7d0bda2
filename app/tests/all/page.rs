//! What the page draws, asked of it in a headless Chromium.

mod browser;
mod systems;

use std::collections::BTreeMap;

use coadjoint_app::page::Page;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

use browser::Browser;

/// Numbers of a page are rounded to those of 32 bits.
const ROUNDED: f64 = 1e-5;

fn vector(value: &Value) -> Vector3<f64> {
    let numbers: Vec<f64> = value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    assert_eq!(numbers.len(), 3, "{value}");
    Vector3::from_row_slice(&numbers)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn rgb(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().map(number).collect()
}

/// Each `#rrggbb` of the page's colours.
fn colours(theme: &Value) -> BTreeMap<&str, Vec<f64>> {
    let channel =
        |hex: &str, k: usize| f64::from(u8::from_str_radix(&hex[k..k + 2], 16).expect("hexadecimal"));
    let colours = theme.as_object().into_iter().flatten();
    colours
        .map(|(name, hex)| {
            (name.as_str(), [1, 3, 5].map(|k| channel(hex.as_str().expect("a text"), k)).to_vec())
        })
        .collect()
}

/// Whether a colour is another one in more or less light.
fn is_shade(pixel: &[f64], of: &[f64]) -> bool {
    let light: Vec<f64> = pixel.iter().zip(of).map(|(a, b)| a / b).collect();
    light.iter().all(|x| (x / light[0] - 1.0).abs() < 0.1)
}

/// Three moments of a run, asked of the page.
fn asked(times: &[f64]) -> String {
    format!("{times:?}.map(t => {{ coadjoint.seek(t); return coadjoint.scene(); }})")
}

#[test]
fn a_pendulum_swings_about_a_horizontal_axis() {
    let Some(browser) = Browser::find("pendulum") else { return };
    let (length, times) = (0.8, [0.0, 0.5, 1.3]);
    let run = systems::pendulum(length).run(&browser.path("pendulum.html"), 300, 0.01);
    let shown = browser.ask(
        "pendulum.html",
        (1280, 800),
        &format!(
            "({{ scenes: {}, pixels: coadjoint.scene().runs[0].bodies.map(({{ screen: [x, y] }}) => coadjoint.pixel([x - 3, y - 3])), \
             corner: coadjoint.pixel([5, 5]), theme: coadjoint.theme }})",
            asked(&times)
        ),
    );
    for (scene, time) in shown["scenes"].as_array().expect("a list").iter().zip(times) {
        let state = run.state(time);
        let (sine, cosine) = (state[1], state[0]);
        let bob = &scene["runs"][0]["bodies"][0];
        assert_eq!(bob["shape"], "sphere");
        // from the lowest position, to the right and up
        let expected = Vector3::new(length * sine, 0.0, -length * cosine);
        let found = vector(&bob["centre"]);
        assert!((found - expected).norm() < ROUNDED, "at {time} s: {found} in place of {expected}");
        let rod = &scene["runs"][0]["links"][0];
        assert!((vector(&rod[0])).norm() < ROUNDED && (vector(&rod[1]) - expected).norm() < ROUNDED, "{rod}");
        let weight = &scene["runs"][0]["arrows"][0];
        assert!(vector(&weight["vector"]).z < 0.0 && (vector(&weight["from"]) - expected).norm() < ROUNDED);
    }
    let colours = colours(&shown["theme"]);
    let (bob, corner) = (rgb(&shown["pixels"][0]), rgb(&shown["corner"]));
    assert!(is_shade(&bob, &colours["solid"]), "{bob:?}");
    assert_eq!(corner, colours["panel"]);
    assert_ne!(bob, corner);
}

#[test]
fn a_body_is_drawn_at_its_attitude_and_its_momentum_in_space_is_constant() {
    let Some(browser) = Browser::find("body") else { return };
    let times = [0.0, 3.1, 7.7];
    let run = systems::free_body().run(&browser.path("body.html"), 1000, 0.01);
    let shown = browser.ask("body.html", (1280, 800), &asked(&times));
    let momentum = Vector3::from_row_slice(&run.state(0.0)[4..7]);
    for (scene, time) in shown.as_array().expect("a list").iter().zip(times) {
        let state = run.state(time);
        let attitude = UnitQuaternion::new_normalize(Quaternion::new(state[0], state[1], state[2], state[3]));
        let body = &scene["runs"][0]["bodies"][0];
        assert_eq!(body["shape"], "box");
        for k in 0..3 {
            let (found, expected) = (vector(&body["axes"][k]), attitude * Vector3::ith(k, 1.0));
            assert!((found - expected).norm() < 1e-4, "axis {k} at {time} s: {found} in place of {expected}");
        }
        let arrow = &scene["runs"][0]["arrows"][0];
        let found = vector(&arrow["vector"]);
        assert!(
            (found - momentum).norm() < 1e-4 * momentum.norm(),
            "at {time} s: {found} in place of {momentum}"
        );
        assert_eq!(scene["notice"], "");
    }
}

/// A page of points and bodies that turn by `angle` from each moment to the next, a second apart.
fn turning(angle: f64, place: f64) -> Page {
    let moments: Vec<f64> = (0..20).map(f64::from).collect();
    let turned: Vec<[f64; 4]> =
        moments.iter().map(|k| [(k * angle / 2.0).cos(), 0.0, 0.0, (k * angle / 2.0).sin()]).collect();
    let position: Vec<[f64; 3]> = moments.iter().map(|k| [place, 0.1 * k, 0.0]).collect();
    let data = serde_json::json!({
        "format": "coadjoint page 1", "title": "turning", "time": moments,
        "runs": [{ "bodies": [{
            "name": "ball", "rotation": turned, "position": position, "shape": { "kind": "sphere", "radius": 0.3 }, "axes": false,
        }] }],
    });
    Page::from_json(&data.to_string()).expect("a page")
}

#[test]
fn what_turns_too_fast_to_be_shown_is_said() {
    let Some(browser) = Browser::find("notices") else { return };
    turning(0.2, 0.0).write(&browser.path("slow.html")).expect("writable");
    turning(2.5, 0.0).write(&browser.path("fast.html")).expect("writable");
    assert_eq!(browser.ask("slow.html", (1280, 800), "coadjoint.scene().notice"), "");
    let notice = browser.ask("fast.html", (1280, 800), "coadjoint.scene().notice");
    assert!(notice.as_str().is_some_and(|notice| notice.contains("2.5 rad")), "{notice}");
    // also a rotor that turns by more than half a turn in each step
    systems::rotor(5000.0).run(&browser.path("rotor.html"), 100, 0.01);
    let notice = browser.ask("rotor.html", (1280, 800), "coadjoint.scene().notice");
    assert!(notice.as_str().is_some_and(|notice| notice.contains("by up to 50 rad (8 turns)")), "{notice}");
    let page = Page::read(&browser.path("rotor.html")).expect("a page");
    let angles = page.runs[0].plots.iter().find(|plot| plot.unit == "rad").expect("an angle");
    assert!((angles.series[0].values[100] - 5002.5).abs() < 1e-2, "{:?}", angles.series[0].values[100]);
    // 150 rad/s, seen 60 times a second, is played slowly enough to be followed
    let run = systems::spinning_body(150.0).run(&browser.path("spinning.html"), 2000, 0.001);
    assert!((run.state(0.0)[4] - 150.0).abs() < 1e-12);
    let shown = browser.ask("spinning.html", (1280, 800), "coadjoint.scene()");
    assert!(number(&shown["speed"]) * 150.0 / 60.0 <= 1.0, "{}", shown["speed"]);
    assert_eq!(shown["notice"], "");
    let fast = "(document.getElementById('speed').value = '1e0', \
                document.getElementById('speed').dispatchEvent(new Event('change')), coadjoint.scene().notice)";
    let notice = browser.ask("spinning.html", (1280, 800), fast);
    assert!(notice.as_str().is_some_and(|notice| notice.contains("2.5 rad from one frame")), "{notice}");
}

#[test]
fn the_eye_is_outside_of_what_is_larger_than_the_motion() {
    let Some(browser) = Browser::find("large") else { return };
    let data = serde_json::json!({
        "format": "coadjoint page 1", "time": [0.0, 1.0],
        "runs": [{ "bodies": [{
            "position": [[0, 0, 0], [0.01, 0, 0]], "shape": { "kind": "sphere", "radius": 1.0 }, "axes": false,
        }] }],
    });
    Page::from_json(&data.to_string()).expect("a page").write(&browser.path("large.html")).expect("writable");
    let seen = "[[5, 5], coadjoint.scene().runs[0].bodies[0].screen.map(x => x - 8)].map(coadjoint.pixel)";
    let shown =
        browser.ask("large.html", (1280, 800), &format!("({{ pixels: {seen}, theme: coadjoint.theme }})"));
    let colours = colours(&shown["theme"]);
    let [corner, ball] = [0, 1].map(|k| rgb(&shown["pixels"][k]));
    assert_eq!(corner, colours["panel"]);
    assert!(is_shade(&ball, &colours["solid"]), "{ball:?}");
}

#[test]
fn names_are_in_view_and_not_over_each_other() {
    let Some(browser) = Browser::find("names-apart") else { return };
    let arrow = |name: &str, to: [f64; 3]| serde_json::json!({ "name": name, "vector": to, "unit": name });
    let data = serde_json::json!({
        "format": "coadjoint page 1", "time": [0.0, 1.0],
        "runs": [{
            "bodies": [{ "position": [[0, 0, 0], [1, 0, 0]], "shape": { "kind": "sphere", "radius": 0.1 } }],
            "arrows": [arrow("instrument", [1.0, 0.0, 0.01]), arrow("Π", [1.0, 0.0, 0.0]), arrow("up", [0.0, 0.0, 1.0])],
        }],
    });
    Page::from_json(&data.to_string()).expect("a page").write(&browser.path("apart.html")).expect("writable");
    let shown = browser.ask(
        "apart.html",
        (1280, 800),
        "({ names: coadjoint.scene().names, canvas: document.querySelector('#space canvas').getBoundingClientRect() })",
    );
    let names = shown["names"].as_array().expect("a list");
    assert_eq!(names.len(), 6, "{names:?}");
    let at = |name: &Value| ["x", "y", "half"].map(|part| number(&name[part]));
    let [width, height] = ["width", "height"].map(|part| number(&shown["canvas"][part]));
    for (k, name) in names.iter().enumerate() {
        let [x, y, half] = at(name);
        assert!(x - half >= 0.0 && x + half <= width && (7.0..height - 7.0).contains(&y), "{name}");
        for other in &names[..k] {
            let [left, top, beside] = at(other);
            assert!((x - left).abs() > half + beside || (y - top).abs() > 14.0, "{name} over {other}");
        }
    }
}

#[test]
fn two_runs_are_overlaid() {
    let Some(browser) = Browser::find("overlay") else { return };
    let mut page = turning(0.2, 0.0);
    page.overlay(turning(0.2, 1.0));
    page.check().expect("a page");
    page.write(&browser.path("both.html")).expect("writable");
    let shown = browser.ask(
        "both.html",
        (1280, 800),
        "(coadjoint.seek(4), { scene: coadjoint.scene(), theme: coadjoint.theme, \
         pixels: coadjoint.scene().runs.map(run => coadjoint.pixel(run.bodies[0].screen.map(x => x - 4))) })",
    );
    let places: Vec<f64> =
        [0, 1].map(|k| vector(&shown["scene"]["runs"][k]["bodies"][0]["centre"]).x).to_vec();
    assert_eq!(places, [0.0, 1.0]);
    let colours = colours(&shown["theme"]);
    let [solid, ghost] = [0, 1].map(|k| rgb(&shown["pixels"][k]));
    assert!(is_shade(&solid, &colours["solid"]), "{solid:?}");
    // a ghost lets most of the background through
    let panel = &colours["panel"];
    let through: Vec<f64> = (0..3).map(|k| ghost[k] / panel[k]).collect();
    assert!(through.iter().all(|part| (0.75..0.99).contains(part)), "{ghost:?} over {panel:?}");
}

/// Presses keys, and tells what is shown after each.
const KEYS: &str = "(() => {
  coadjoint.pause();
  const press = (key, shiftKey = false) => {
    document.dispatchEvent(new KeyboardEvent('keydown', { key, shiftKey, bubbles: true, cancelable: true }));
    const { time, playing, speed, camera } = coadjoint.scene();
    return { time, playing, speed, camera };
  };
  const shown = {
    home: press('Home'), right: press('ArrowRight'), next: press('.'), end: press('End'), before: press('ArrowLeft'),
    play: press(' '), pause: press(' '), faster: press('+'), slower: press('-'),
    left: press('a'), up: press('ArrowUp', true), closer: press('e'), reset: press('0'),
  };
  press('?');
  shown.help = document.getElementById('help').open;
  document.getElementById('help').close();
  const image = coadjoint.png();
  shown.png = [image.slice(0, 22), image.length];
  return shown;
})()";

#[test]
fn keys_play_seek_and_turn_and_pictures_are_saved() {
    let Some(browser) = Browser::find("keys") else { return };
    turning(0.2, 0.0).write(&browser.path("keys.html")).expect("writable");
    let shown = browser.ask("keys.html", (1280, 800), KEYS);
    let time = |name: &str| number(&shown[name]["time"]);
    assert_eq!((time("home"), time("end")), (0.0, 19.0));
    assert!(
        (time("right") - 0.19).abs() < 1e-9 && time("next") == 1.0 && (time("before") - 18.81).abs() < 1e-9,
        "{shown}"
    );
    assert_eq!(
        (&shown["play"]["playing"], &shown["pause"]["playing"]),
        (&Value::Bool(true), &Value::Bool(false))
    );
    let speed = |name: &str| number(&shown[name]["speed"]);
    assert!(speed("faster") > speed("slower") && speed("slower") == speed("home"), "{shown}");
    let camera = |name: &str, part: &str| number(&shown[name]["camera"][part]);
    assert!(
        camera("left", "yaw") > camera("home", "yaw") && camera("up", "pitch") > camera("left", "pitch"),
        "{shown}"
    );
    assert!(camera("closer", "zoom") > 1.0, "{shown}");
    assert_eq!(shown["reset"]["camera"], shown["home"]["camera"]);
    assert_eq!(shown["help"], true);
    assert_eq!(shown["png"][0], "data:image/png;base64,");
    assert!(number(&shown["png"][1]) > 5000.0, "{}", shown["png"]);
}

/// Drags, pinches, double clicks, and clicks in the middle of the first plot.
const POINTERS: &str = "(() => {
  coadjoint.pause();
  Element.prototype.setPointerCapture = () => {}; // no finger is really down
  const at = (element, type, pointerId, clientX, clientY) => element.dispatchEvent(
    new PointerEvent(type, { pointerId, clientX, clientY, button: 0, buttons: 1, bubbles: true }));
  const camera = () => coadjoint.scene().camera;
  const canvas = document.querySelector('#space canvas'), shown = { first: camera() };
  at(canvas, 'pointerdown', 1, 100, 100);
  at(canvas, 'pointermove', 1, 150, 100);
  shown.dragged = camera();
  at(canvas, 'pointerdown', 2, 250, 100);
  at(canvas, 'pointermove', 2, 350, 100);
  shown.pinched = camera();
  at(canvas, 'pointerup', 1, 150, 100);
  at(canvas, 'pointerup', 2, 350, 100);
  at(canvas, 'pointermove', 1, 500, 100);
  shown.released = camera();
  canvas.dispatchEvent(new MouseEvent('dblclick'));
  shown.reset = camera();
  const plot = document.querySelector('.sheet canvas'), { left, right, top } = plot.getBoundingClientRect();
  at(plot, 'pointerdown', 3, (left + 54 + right - 10) / 2, top + 20);
  shown.time = coadjoint.scene().time;
  return shown;
})()";

#[test]
fn pointers_turn_and_zoom_the_view_and_seek_in_plots() {
    let Some(browser) = Browser::find("pointers") else { return };
    systems::free_body().run(&browser.path("pointers.html"), 1000, 0.01);
    let shown = browser.ask("pointers.html", (1280, 800), POINTERS);
    let camera = |name: &str, part: &str| number(&shown[name][part]);
    assert!((camera("first", "yaw") - camera("dragged", "yaw") - 0.4).abs() < 1e-9, "{shown}");
    assert!((camera("pinched", "zoom") - 2.0).abs() < 1e-9, "{shown}");
    assert_eq!(shown["released"], shown["pinched"]);
    assert_eq!(shown["reset"], shown["first"]);
    assert!((number(&shown["time"]) - 5.0).abs() < 0.02, "{shown}");
}

#[test]
fn nothing_overflows_on_a_phone() {
    let Some(browser) = Browser::find("phone") else { return };
    systems::free_body().run(&browser.path("phone.html"), 100, 0.01);
    let widths =
        "[innerWidth, document.documentElement.scrollWidth, document.getElementById('space').clientWidth]";
    let shown = browser.ask("phone.html", (390, 844), widths);
    let [window, page, space] = [0, 1, 2].map(|k| number(&shown[k]));
    assert!(window <= 500.0 && page <= window && space > 0.8 * window, "{shown}");
}

/// Two bodies that are seen along the first axis, at one moment after the other.
fn seen_along_the_first_axis(bodies: &Value) -> Page {
    let data = serde_json::json!({
        "format": "coadjoint page 1", "time": [0.0, 1.0],
        "space": { "axes": ["", "", ""], "look": [0.0, 0.0] }, "runs": [{ "bodies": bodies }],
    });
    Page::from_json(&data.to_string()).expect("a page")
}

/// The colours of the picture at both moments, at the middle and beside it.
const SEEN: &str = "(async () => {
  coadjoint.pause();
  const at = async time => {
    coadjoint.seek(time);
    const [x, y] = coadjoint.scene().runs[0].bodies[0].screen;
    await new Promise(done => setTimeout(done, 200)); // an SVG is decoded apart
    return [-60, 0, 60].map(right => coadjoint.pixel([x + right, y - 3]));
  };
  const shown = { first: await at(0), last: await at(1), theme: coadjoint.theme };
  const { webgl, shadows } = coadjoint.scene();
  return { ...shown, webgl, shadows };
})()";

/// Two balls that change places, the nearer before the farther.
fn balls() -> Page {
    let ball = |from: f64, colour: &str| {
        serde_json::json!({
            "position": [[from, 0, 0], [-from, 0, 0]], "shape": { "kind": "sphere", "radius": 0.6 },
            "axes": false, "trail": false, "colour": colour,
        })
    };
    seen_along_the_first_axis(&Value::Array(vec![ball(1.0, "solid"), ball(-1.0, "second")]))
}

#[test]
fn what_is_behind_a_body_is_hidden() {
    let Some(browser) = Browser::find("behind") else { return };
    balls().write(&browser.path("balls.html")).expect("writable");
    let shown = browser.ask("balls.html", (1280, 800), SEEN);
    assert_eq!(
        (&shown["webgl"], &shown["shadows"]),
        (&Value::Bool(true), &Value::Bool(false)),
        "a software renderer"
    );
    let colours = colours(&shown["theme"]);
    for (moment, nearer, farther) in [("first", "solid", "second"), ("last", "second", "solid")] {
        let middle = rgb(&shown[moment][1]);
        assert!(
            is_shade(&middle, &colours[nearer]) && !is_shade(&middle, &colours[farther]),
            "{moment}: {middle:?}"
        );
    }
}

#[test]
fn of_bodies_that_cross_each_shows_where_it_is_nearer() {
    let Some(browser) = Browser::find("crossing") else { return };
    // to the right the first is nearer at the first moment, and the second at the last
    let plate = |angle: f64, colour: &str| {
        let [c, s] = [(angle / 2.0).cos(), (angle / 2.0).sin()];
        serde_json::json!({
            "rotation": [[c, 0.0, 0.0, s], [c, 0.0, 0.0, -s]], "axes": false, "trail": false, "colour": colour,
            "shape": { "kind": "box", "size": [0.02, 2.0, 1.0] },
        })
    };
    let plates = Value::Array(vec![plate(-0.5, "solid"), plate(0.5, "second")]);
    seen_along_the_first_axis(&plates).write(&browser.path("plates.html")).expect("writable");
    let shown = browser.ask("plates.html", (1280, 800), SEEN);
    let colours = colours(&shown["theme"]);
    for (moment, left, right) in [("first", "second", "solid"), ("last", "solid", "second")] {
        for (place, nearer) in [(0, left), (2, right)] {
            let found = rgb(&shown[moment][place]);
            assert!(is_shade(&found, &colours[nearer]), "{moment}, {place}: {found:?} is no {nearer}");
        }
    }
}

#[test]
fn without_webgl_the_motion_is_drawn_as_svg() {
    let Some(browser) = Browser::find("svg") else { return };
    balls().write(&browser.path("balls.html")).expect("writable");
    let shown = browser.without_webgl().ask("balls.html", (1280, 800), SEEN);
    assert_eq!(shown["webgl"], false);
    let colours = colours(&shown["theme"]);
    for (moment, nearer) in [("first", "solid"), ("last", "second")] {
        assert!(is_shade(&rgb(&shown[moment][1]), &colours[nearer]), "{moment}: {}", shown[moment]);
    }
}

/// How dark the picture is, all in all, and whether shadows are in it.
const DARKNESS: &str = "(() => {
  coadjoint.pause();
  coadjoint.seek(0);
  const { shadows } = coadjoint.scene(), { width, height } = document.querySelector('#space canvas');
  const { data } = document.querySelector('#space canvas').getContext('2d').getImageData(0, 0, width, height);
  return { shadows, darkness: data.reduce((total, level) => total + (255 - level) / 255, 0) };
})()";

#[test]
fn bodies_throw_shadows_where_a_graphics_processor_draws() {
    let Some(browser) = Browser::find("shadows") else { return };
    let data = serde_json::json!({
        "format": "coadjoint page 1", "time": [0.0, 1.0], "space": { "ground": 0.0, "look": [-0.9, 0.6] },
        "runs": [{ "bodies": [{ "position": [[0, 0, 0.32], [0.5, 0, 0.32]], "shape": { "kind": "sphere", "radius": 0.3 }, "trail": false }] }],
    });
    let page = Page::from_json(&data.to_string()).expect("a page").to_html();
    // the renderer by another name
    let card = "<script nonce=\"ask\">{ const { prototype } = WebGL2RenderingContext, { getParameter } = prototype; \
                prototype.getParameter = function (name) { return name === 0x9246 ? 'card' : getParameter.call(this, name); }; }</script></head>";
    std::fs::write(browser.path("software.html"), &page).expect("writable");
    std::fs::write(browser.path("card.html"), page.replace("</head>", card)).expect("writable");
    let [software, shaded] =
        ["software.html", "card.html"].map(|name| browser.ask(name, (1280, 800), DARKNESS));
    assert_eq!((&software["shadows"], &shaded["shadows"]), (&Value::Bool(false), &Value::Bool(true)));
    let [least, most] = [&software, &shaded].map(|shown| number(&shown["darkness"]));
    assert!(most > least + 500.0, "{least}, with shadows {most}");
}

/// Counts the pictures that are drawn in six frames, at rest, after one change, and playing.
const COUNTED: &str = "(async () => {
  const pictures = async change => {
    change();
    const before = coadjoint.pictures();
    await new Promise(done => setTimeout(done, 300));
    return coadjoint.pictures() - before;
  };
  await pictures(coadjoint.pause);
  return { resting: await pictures(() => {}), sought: await pictures(() => coadjoint.seek(3)), playing: await pictures(coadjoint.play) };
})()";

#[test]
fn nothing_is_drawn_while_nothing_changes() {
    let Some(browser) = Browser::find("resting") else { return };
    turning(0.2, 0.0).write(&browser.path("resting.html")).expect("writable");
    let shown = browser.ask("resting.html", (1280, 800), COUNTED);
    assert_eq!((number(&shown["resting"]), number(&shown["sought"])), (0.0, 1.0), "{shown}");
    assert!(number(&shown["playing"]) > 3.0, "{shown}");
}

/// How many pixels of the saved picture, about the place of each name, have the name's colour.
const NAMED: &str = "(async () => {
  coadjoint.pause();
  const { names } = coadjoint.scene(), image = new Image();
  await new Promise(done => setTimeout(done, 200));
  await new Promise(done => { image.onload = done; image.src = coadjoint.png(); });
  const pen = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  return names.map(({ name, x, y, colour }) => {
    pen.drawImage(image, 6 - x, 6 - y);
    const { data } = pen.getImageData(0, 0, 12, 12), hex = coadjoint.theme[colour];
    const of = [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
    const pixels = Array.from({ length: 144 }, (_, k) => [...data.slice(4 * k, 4 * k + 3)]);
    return { name, pixels: pixels.filter(pixel => pixel.every((x, k) => Math.abs(x - of[k]) < 70)).length };
  });
})()";

#[test]
fn the_saved_picture_has_the_names() {
    let Some(browser) = Browser::find("names") else { return };
    let page = turning(0.2, 0.0);
    page.write(&browser.path("names.html")).expect("writable");
    for browser in
        [Browser::find("names"), Browser::find("names").map(Browser::without_webgl)].into_iter().flatten()
    {
        let shown = browser.ask("names.html", (1280, 800), NAMED);
        let names: Vec<&Value> = shown.as_array().expect("a list").iter().collect();
        assert_eq!(
            names.iter().map(|name| name["name"].as_str().expect("a text")).collect::<Vec<_>>(),
            ["x", "y", "z"]
        );
        assert!(names.iter().all(|name| number(&name["pixels"]) >= 3.0), "{shown}");
    }
}
