"""Descriptions: the ways to write one, and what is wrong with one at its place in the string."""

import pickle

import numpy as np
import pytest

import coadjoint as co
from conftest import HEAVY_TOP

ATTRIBUTE = "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)"
FIELDS = {"inertia": "inertia: Vector3 [kg m²]", "parameters": "weight: float [N], chi: Vector3 [m]"}
WHOLE = """#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct HeavyTop {
    #[inertia] #[unit("kg m²")] inertia: Vector3<f64>,
    #[unit("N")] weight: f64,
    #[unit("m")] chi: Vector3<f64>,
}"""


def test_three_ways_to_write_one_system():
    made = [
        co.System(**HEAVY_TOP),
        co.System(ATTRIBUTE, name="HeavyTop", **FIELDS),
        co.System(WHOLE),
        co.System(
            group={"attitude": "SO3"},
            advected={"gamma": "R3"},
            potential=HEAVY_TOP["potential"],
            inertia={"inertia": "Vector3 [kg m²]"},
            parameters={"weight": "f64 [N]", "chi": "Vector3<f64> [m]"},
            name="HeavyTop",
        ),
    ]
    ends = []
    for system in made:
        assert system.parameter_quantities == made[0].parameter_quantities
        # a factor with a name has momenta with that name
        advected = system.state_quantities[-1].name
        assert (system.name, advected, system.casimir_names[0]) == ("HeavyTop", "gamma", "|gamma|²")
        top = system([1, 10, 100, 1, 0, 0, 1])
        y = np.array([1, 0, 0, 0, 1, 1, 1, 0, 0, 1.0])
        ends.append(top.run(y, 1, step=0.01).y.flat[-1].tolist())
    assert ends[0] == ends[1] == ends[2] == ends[3]


def test_forces_arrays_and_switches():
    system = co.System(
        group={"hull": "SO3", "arm": "SO2"},
        control="motor: R1",
        hamiltonian="hull_momentum.dot(&hull_momentum.component_div(&inertia)) / 2.0 + arm_momentum.norm_squared() * weights[1]",
        force={"arm": "motor - friction * arm_momentum"},
        parameters="""
            inertia: Vector3 [kg m²]
            weights: [f64; 2]
            friction: float [1/s]
        """,
        units={"motor": "N m"},
        methods="Midpoint",
        retractions="Exponential, Cayley",
    )
    assert [one.name for one in system.control_quantities] == ["motor"]
    assert system.control_quantities[0].unit == "N m"
    assert "Midpoint<Cayley>" in system.schemes
    names = [(one.name, one.unit) for one in system.parameter_quantities]
    assert names == [("inertia", "kg m²"), ("weights_0", None), ("weights_1", None), ("friction", "1/s")]


def test_inertias_of_several_factors():
    group = {"attitude": "SO3", "place": "R3"}
    potential = "mass * gravity * place.z"
    by_factor = co.System(
        group=group,
        inertia={"attitude": "inertia: Vector3 [kg m²]", "place": "mass: float [kg]"},
        parameters="gravity: float",
        potential=potential,
    )
    whole = co.System(
        """#[lie_poisson_system(group(attitude: SO3, place: R3), potential = mass * gravity * place.z)]
        struct System {
            #[inertia(attitude)] #[unit("kg m²")] inertia: Vector3<f64>,
            #[inertia(place)] #[unit("kg")] mass: f64,
            gravity: f64,
        }"""
    )
    assert by_factor.parameter_quantities == whole.parameter_quantities
    ends = []
    for system in (by_factor, whole):
        body = system(inertia=[1, 2, 3], mass=2, gravity=9.81)
        y = body.state(attitude_momentum=[1, 2, 3], place=[0, 0, 5], place_momentum=[2, 0, 0])
        ends.append(body.run(y, 1, step=0.1).y.flat[-1].tolist())
    assert ends[0] == ends[1] and abs(ends[0][7] - 1) < 1e-12

    # of two at once, and of one with several fields
    joint = co.System(group={"hull": "SO3", "arm": "SO2"}, inertia={"hull, arm": "inertia: Matrix4"})
    assert [one.shape for one in joint.parameter_quantities] == [(4, 4)]
    for inertia, source in (
        ({"attitud": "inertia: Vector3", "place": "mass: float"}, ("inertia", "attitud", 1)),
        ({"attitude": "inertia: Vektor3", "place": "mass: float"}, ("inertia['attitude']", "inertia: Vektor3", 10)),
    ):
        with pytest.raises(co.DescriptionError) as caught:
            co.System(group=group, inertia=inertia)
        assert source in [(at.source, at.text, at.column) for one in caught.value.problems if (at := one.place)]


def test_words_for_numbers_in_controls():
    for word in ("float", "f64", "scalar", "number"):
        for control in (f"servo: {word}, number: {word}", {"servo": word, "number": f" {word}"}):
            cart = co.System(group="R1", control=control, force="vector![servo + number]", inertia="mass: float")
            assert [(one.name, one.shape) for one in cart.control_quantities] == [("servo", ()), ("number", ())]
    many = co.System(group="R1", control="servos: [float; 2]", force="vector![servos[1]]", inertia="mass: float")
    assert len(many.control_quantities) == 2
    with pytest.raises(co.DescriptionError) as caught:
        co.System(group="R1", control="servo: float, other: floot", force="vector![servo]", inertia="mass: float")
    place = caught.value.problems[0].place
    assert (place.column, place.text) == (22, "servo: float, other: floot")


def test_arrays_are_given_whole():
    system = co.System(
        group="SO3",
        inertia="inertia: Vector3",
        parameters="chis: [Vector3; 2], weights: [float; 3]",
        potential="weights[0] * chis[0].dot(&chis[1]) * attitude.w + weights[1] * weights[2]",
    )
    parts = system(inertia=[1, 2, 3], chis_0=[1, 2, 3], chis_1=[4, 5, 6], weights_0=7, weights_1=8, weights_2=9)
    assert system(inertia=[1, 2, 3], chis=[[1, 2, 3], [4, 5, 6]], weights=(7, 8, 9)) == parts
    assert system(inertia=[1, 2, 3], chis=[[1, 2, 3], [4, 5, 6]], weights_0=7, weights_1=8, weights_2=9) == parts
    assert parts.replace(weights=[1, 2, 3]) == parts.replace(weights_0=1, weights_1=2, weights_2=3) != parts
    members = parts.ensemble({"momentum": [1, 0, 0]}, {"weights": [[1, 2, 3], [4, 5, 6]]}, t_span=0.1, step=0.1)
    assert members.parameters.weights_1.tolist() == [2, 5] and (members.parameters.chis_1 == [4, 5, 6]).all()
    for wrong in ([1, 2], [[1, 2, 3], [4, 5, 6]], 1):
        with pytest.raises(ValueError, match="`weights"):
            parts.replace(weights=wrong)
    with pytest.raises(AttributeError, match="it has weights_0, weights_1, weights_2"):
        parts.parameters.weights
    with pytest.raises(ValueError, match="did you mean `weights_"):
        parts.replace(weight=1)


def test_definitions_stand_beside():
    body = co.System(
        group="R1",
        potential="density(position.x) * SCALE",
        inertia="mass: float",
        definitions="const SCALE: f64 = 2.0;\n#[expression]\nfn density(height: f64) -> f64 { (-height).exp() }",
    )(mass=1)
    assert body.energy([0.0, 0.0]) == 2.0
    # constants follow the parameters of members too
    sol = body.ensemble([[0.0, 0.0], [1.0, 0.0]], {"mass": [1.0, 2.0]}, t_span=1, step=0.01)
    alone = body.replace(mass=2.0).run([1.0, 0.0], 1, step=0.01, scheme="cayley" if "Cayley" in body.system.schemes else None)
    assert np.abs(sol.end.flat[1] - alone.y.flat[-1]).max() < 1e-14


WRONG = [
    # a key, what it is, and where what is wrong with it stands
    ({"potential": "wait * gamma.dot(&chi)"}, ("potential", 1, 1, 4), "there is no `wait` here"),
    ({"potential": "weight *\n  gama.dot(&chi)"}, ("potential", 2, 3, 4), "did you mean `gamma`?"),
    ({"potential": "weight * (gamma.dot(&chi)"}, ("potential", 1, 10, 1), "a bracket or a quote is not closed"),
    ({"potential": "weight * gamma"}, ("potential", 1, 1, 14), "must be a scalar"),
    ({"potential": "weight * Gamma(gamma.x)"}, ("potential", 1, 10, None), ""),
    ({"group": "SO7x"}, ("group", 1, 1, 4), "there is no group `SO7x`"),
    ({"advected": "gamma: R9"}, ("advected", 1, 8, 2), ""),
    ({"advected": "gamma R3"}, ("advected", 1, 7, 2), "expected a colon"),
    ({"parameters": "weight: float, chi: Vektor3"}, ("parameters", 1, 21, 7), "`chi` cannot be of this type"),
    ({"parameters": "weight: float [N],\n   chi: Vektor3 [m]"}, ("parameters", 2, 9, 7), "`chi` cannot be of this type"),
    ({"parameters": {"weight": "float", "chi": "Vektor3 [m]"}}, ("parameters['chi']", 1, 1, 7), "`chi` cannot be of this type"),
    ({"parameters": "weight float, chi: Vector3"}, ("parameters", 1, 8, None), "expected `:`"),
    ({"inertia": "inertia: Vector2"}, ("inertia", 1, None, None), ""),
    ({"methods": "Midpiont"}, ("methods", 1, 1, 8), "Midpoint"),
    ({"retractions": "Caley"}, ("retractions", 1, 1, 5), "Cayley"),
    ({"force": "thrust"}, ("force", 1, 1, 6), "there is no `thrust`"),
    ({"invariance": "up"}, ("invariance", 1, 1, 2), ""),
    ({"units": {"momentun": "kg"}}, ("units", 1, None, None), "momentun"),
]


@pytest.mark.parametrize(("change", "place", "message"), WRONG, ids=lambda value: str(value)[:40])
def test_what_is_wrong_is_told_at_its_place(change, place, message):
    with pytest.raises(co.DescriptionError) as caught:
        co.System(**{**HEAVY_TOP, **change})
    error = caught.value
    assert isinstance(error, ValueError) and message in str(error)
    found = [one.place for one in error.problems if one.place and one.place.source == place[0]]
    assert found, error
    source, line, column, width = place
    assert any(
        at.line == line and column in (None, at.column) and width in (None, at.width) for at in found
    ), (found, error)
    text = next(iter(change.values()))
    if isinstance(text, str):
        for at in found:
            assert at.text == text.split("\n")[at.line - 1]
            assert f"--> {source}:{at.line}:{at.column}" in str(error)


PLACE = {
    "group": {"attitude": "SO3", "place": "R3"},
    "inertia": {"attitude": "inertia: Vector3", "place": "mass: float"},
    "parameters": "k: float",
    "potential": "k * place.z",
}
#: What would end its own key and begin another one, or hide what follows it; and where that is.
BREAKS = [
    ({"potential": "k * (place.x - 1.0)) * (place.x + 1.0"}, ("potential", 20)),
    ({"potential": "0.0, force(place = vector![1.0, 2.0, 3.0])"}, ("potential", 4)),
    ({"potential": "k * place.x,"}, ("potential", 12)),
    ({"potential": "k * place.x]] struct B {"}, ("potential", 12)),
    ({"potential": "(k * place.x]"}, ("potential", 13)),
    ({"potential": "k * place.x /* of it all"}, ("potential", 13)),
    ({"potential": "k * place.x /* of /* it */ all"}, ("potential", 13)),
    ({"potential": 'k.expect("of it all)'}, ("potential", 10)),
    ({"potential": 'k.expect(r#"of it all")'}, ("potential", 12)),
    ({"potential": "k * place.fixed_rows::<2>(0).x, taylor"}, ("potential", 31)),
    ({"potential": "k // a, comment\n, taylor"}, ("potential", 1)),
    ({"hamiltonian": "k, taylor"}, ("hamiltonian", 2)),
    ({"lagrangian": "k) , (taylor"}, ("lagrangian", 2)),
    ({"force": {"place": "vector![1.0, 2.0, 3.0]) + (vector![5.0, 5.0, 5.0]"}}, ("force['place']", 23)),
    ({"force": {"place": "vector![1.0, 2.0, 3.0], attitude = momentum"}}, ("force['place']", 23)),
    ({"force": {"place = vector![0.0, 0.0, 0.0], attitude": "k"}}, ("force", 1)),
    ({"force": "place = vector![1.0, 2.0, 3.0]), potential(k"}, ("force", 31)),
    ({"group": "SO3, taylor"}, ("group", 4)),
    ({"group": {"attitude": "SO3, place: R3"}}, ("group['attitude']", 4)),
    ({"advected": "gamma: attitude::R3), control(u: R3"}, ("advected", 20)),
    ({"advected": {"gamma": "attitude::R3, delta: attitude::R3"}}, ("advected['gamma']", 13)),
    ({"control": {"u": "SVector<f64, 3>, v: f64"}}, ("control['u']", 16)),
    ({"control": {"u": "SVector<f64, v: f64"}}, ("control['u']", 12)),
    ({"event": {"low": "place.z, falling, high = place.z"}}, ("event['low']", 8)),
    ({"event": "low = place.z), control(u: R3"}, ("event", 14)),
    ({"methods": "Midpoint), retractions(Cayley"}, ("methods", 9)),
    ({"retractions": "Cayley), methods(Midpoint"}, ("retractions", 7)),
    ({"derivatives": "state), methods(Midpoint"}, ("derivatives", 6)),
    ({"invariance": "right, taylor"}, ("invariance", 6)),
    ({"parameters": "k: float } struct B { a: float"}, ("parameters", 10)),
    ({"parameters": {"k": "float, j: float"}}, ("parameters['k']", 6)),
    ({"parameters": {"k: float, j": "float"}}, ("parameters", 1)),
    ({"parameters": "k: float = 3"}, ("parameters", 10)),
    ({"definitions": "const SCALE: f64 = 2.0; /* of it all"}, ("definitions", 25)),
    ({"units": {"place": "m", "k = x": "m"}}, ("units", 1)),
]


@pytest.mark.parametrize(("change", "place"), BREAKS, ids=lambda value: str(value)[:60])
def test_what_stands_in_a_string_stays_in_its_place(change, place):
    with pytest.raises(co.DescriptionError) as caught:
        co.System(**{**PLACE, **change})
    found = [(one.place.source, one.place.column) for one in caught.value.problems if one.place]
    if "comment" in str(change):
        assert (place[0], 2) in [(at.source, at.line) for one in caught.value.problems if (at := one.place)]
    else:
        assert place in found, caught.value


def test_a_unit_is_one_text():
    with pytest.raises(co.DescriptionError, match="2 units"):
        co.System(**PLACE, units={"place": 'm", place_momentum = "kg'})
    assert co.System(**{**PLACE, "parameters": 'k: float [m"]'}).parameter_quantities[-1].unit == 'm"'


def test_strings_may_have_brackets_commas_and_comments_of_their_own():
    system = co.System(
        group="attitude: SO3, place: R3",
        inertia=PLACE["inertia"],
        parameters="""
            k: float,     // a spring, of some stiffness
            /* two points, [so far] */
            points: [Vector3; 2] [m]
        """,
        potential="k * SVector::<f64, 2>::new(points[0].x, points[1].y).dot(&place.fixed_rows::<2>(0)) // a ) and a ,\n /* ( /* [ */ , */ + 0.0",
        force="attitude = vector![0.0, 0.0, k], place = vector![k, 0.0, 0.0] + u,",
        control={"u": "SVector<f64, 3>"},
    )
    assert [(one.name, one.unit) for one in system.parameter_quantities[2:]] == [("k", None), ("points_0", "m"), ("points_1", "m")]
    body = system(inertia=[1, 1, 1], mass=1, k=2.0, points=[[3, 0, 0], [0, 0, 0]])
    assert body.energy(body.state(place=[5, 0, 0])) == 30
    # the potential pulls with 6, the force pushes with 2
    assert body.rhs(0, body.state())[-3:].tolist() == [-4, 0, 0]
    by_name = co.System(**PLACE, force={"attitude": "vector![0.0, 0.0, k]", "place": "vector![k, 0.0, 0.0]"})(
        inertia=[1, 1, 1], mass=1, k=2.0
    )
    assert by_name.rhs(0, by_name.state())[-3:].tolist() == [2, 0, -2]


def test_events_are_described():
    for event in ("low = place.z, falling, far = place.x", {"low": "place.z, falling", "far": "place.x"}):
        assert "falling" in co.System(**PLACE, event=event).text
    with pytest.raises(co.DescriptionError, match="did you mean `falling`"):
        co.System(**PLACE, event={"low": "place.z, fallin"})
    with pytest.raises(co.DescriptionError, match="did you mean `place`") as caught:
        co.System(**PLACE, event={"low": "plase.z"})
    assert repr(caught.value.problems[0].place) == "event['low']:1:1"


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"parameters": "k: float, k: float"}, "parameters:1:11"),
        ({"parameters": "k: float [N],\n  k: Vector3"}, "parameters:2:3"),
        ({"parameters": "mass: float"}, "parameters:1:1"),
        ({"parameters": {"mass": "float"}}, "parameters['mass']:1:1"),
        ({"inertia": {"attitude": "mass: Vector3", "place": "mass: float"}}, "inertia['place']:1:1"),
    ],
)
def test_a_name_is_given_once(change, place):
    with pytest.raises(co.DescriptionError, match="`(k|mass)` is given twice") as caught:
        co.System(**{**PLACE, **change})
    assert [repr(one.place) for one in caught.value.problems] == [place]


def test_a_name_of_a_whole_text_is_given_once():
    with pytest.raises(co.DescriptionError, match="`weight` is the name of a field before"):
        co.System(WHOLE.replace("chi: Vector3", "weight: Vector3").replace("weight * gamma.dot(&chi)", "gamma.x"))
    # the others are told of at their places by the library
    for key in ("advected", "control"):
        with pytest.raises(co.DescriptionError, match="a name of its own"):
            co.System(**{**HEAVY_TOP, key: "weight: R3"})


def test_one_problem_is_told_once():
    with pytest.raises(co.DescriptionError) as caught:
        co.System(group="R1", inertia="m: float [kg], extra: float")
    assert len(caught.value.problems) == 1 and str(caught.value).count("`extra`") == 1


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"group": "R1"}, 'Give `inertia="…"`'),
        ({"inertia": "m: float"}, 'write `group="SO3"`'),
        ({"group": "R1", "inertia": "m: float, k: float"}, "others are `parameters`"),
        ({"group": "R1", "inertia": "m: Vektor3"}, "a parameter is `float`, `Vector1` to `Vector6`"),
        ({"group": {"a": "R1", "b": "R1"}, "inertia": {"a": "m: float"}}, 'give `inertia={"b": "…"}`'),
        ({"group": "R1", "inertia": "m: float", "units": {"m": "kg"}}, "stands behind its type: `[kg]`"),
        ({"group": "R1", "inertia": "m: float", "units": {"position": ""}}, 'write `units={"momentum": "N m s"}`'),
        ({"group": "R1", "inertia": "m: float", "potential": ""}, 'write `potential="weight'),
        ({"group": "R1", "inertia": "m: float", "advected": ""}, 'write `advected="gamma: R3"`'),
        ({"group": "R1", "inertia": "m: float", "methods": "Cayley"}, '`retractions="…"` names others'),
    ],
    ids=str,
)
def test_errors_speak_of_keywords(keys, said):
    with pytest.raises(co.DescriptionError) as caught:
        co.System(**keys)
    assert said in str(caught.value) and "#[" not in str(caught.value) and "<f64>" not in str(caught.value)


def test_a_text_of_rust_is_told_of_in_rust():
    with pytest.raises(co.DescriptionError, match=r"write `advected\(gamma: R3\)`"):
        co.System("group = SO3, advected gamma: R3", inertia="inertia: Vector3")
    with pytest.raises(co.DescriptionError, match=r"Mark one field with `#\[inertia\]`"):
        co.System(WHOLE.replace("#[inertia]", ""))


def test_all_problems_at_once():
    with pytest.raises(co.DescriptionError) as caught:
        co.System(**{**HEAVY_TOP, "potential": "wait * gama.x", "parameters": "weight: String"})
    assert len(caught.value.problems) >= 2
    assert {one.place.source for one in caught.value.problems if one.place} == {"potential", "parameters"}


def test_a_whole_text_has_its_own_lines():
    with pytest.raises(co.DescriptionError) as caught:
        co.System(WHOLE.replace("gamma.dot", "gama.dot"))
    assert caught.value.problems[0].place.column == 1 + WHOLE.index("gamma.dot")


@pytest.mark.parametrize(
    ("positional", "keys", "error"),
    [
        (None, {}, co.DescriptionError),
        ("", {}, co.DescriptionError),
        ("group = SO3", {}, co.DescriptionError),
        ("struct A;", {}, co.DescriptionError),
        (WHOLE, {"group": "SO3"}, TypeError),
        (3, {}, TypeError),
        (None, {"group": 3}, TypeError),
        (None, {"group": "SO3", "inertia": 3}, TypeError),
        (None, {"group": "SO3", "inertia": {"inertia": 3}}, TypeError),
        (None, {"group": "SO3", "potential": {"a": "b"}, "inertia": "i: Vector3"}, TypeError),
        (None, {"group": "SO3", "units": "kg", "inertia": "i: Vector3"}, TypeError),
        (None, {"group": "SO3", "inertia": "i: Vector3", "name": "no name"}, ValueError),
        (None, {"group": "SO3", "inertia": "i: Vector3\0"}, co.DescriptionError),
        (None, {"group": "SO3", "inertia": "i: Vector3", "potential": "(" * 5000}, co.DescriptionError),
        (None, {"group": "SO3", "inertia": "i: Vector3", "potential": "1.0}] struct B {"}, co.DescriptionError),
        (None, {"group": "SO3", "inertia": "i: Vector3", "no_such_key": "1"}, TypeError),
    ],
)
def test_what_is_no_description_is_refused(positional, keys, error):
    with pytest.raises(error):
        co.System(positional, **keys)


def test_systems_are_pickled(HeavyTop, top, y0):
    again = pickle.loads(pickle.dumps(HeavyTop))
    assert again == HeavyTop and hash(again) == hash(HeavyTop) and repr(again) == repr(HeavyTop)
    moved = pickle.loads(pickle.dumps(top))
    assert moved == top and moved.energy(y0) == top.energy(y0)
    sol = top.run(y0, 1, step=0.01)
    back = pickle.loads(pickle.dumps(sol))
    assert (back.y.flat == sol.y.flat).all() and (back(0.123).flat == sol(0.123).flat).all()
    state = pickle.loads(pickle.dumps(y0))
    assert state == y0 and state.gamma[2] == 1.0
    error = pickle.loads(pickle.dumps(co.StepError("no", 1.0, np.ones(3), 4)))
    assert (error.t, error.step, str(error)) == (1.0, 4, "no")


def test_units_and_words_are_shown(HeavyTop, top, y0):
    assert "inertia [kg m²]: 3 vector" in repr(HeavyTop) and "momentum·gamma" in HeavyTop.__doc__
    assert repr(top) == "HeavyTop(inertia=[1.0, 10.0, 100.0] kg m², weight=1.0 N, chi=[0.0, 0.0, 1.0] m)"
    assert "gamma=[0. 0. 1.]" in repr(y0)
    listed = co.systems.heavy_top
    assert listed.about == "A rigid body that turns about a fixed point under gravity"
    assert listed.parameter_quantities[0].doc.startswith("Principal moments of inertia")
    assert "momentum=[1. 1. 1.] kg m²/s" in repr(listed.state())
    with pytest.raises(AttributeError, match="did you mean `heavy_top`"):
        co.systems.heavy_tops
    assert "heavy_top" in dir(co.systems)
