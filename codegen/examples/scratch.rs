use coadjoint_codegen::{expr::*, group::*, kernel::*, method::*, model::*};
fn sym<'a>(a: &'a Arena, n: &str, c: &[&str], s: Stage) -> Vector<'a> {
    Vector(c.iter().map(|x| a.symbol(format!("{n}_{x}"), s)).collect())
}
fn main() {
    for free in [true, false] {
        for r in Retraction::ALL {
            let a = Arena::new();
            let xyz = ["x", "y", "z"];
            let inertia = sym(&a, "inertia", &xyz, Stage::Parameters);
            let weight = a.symbol("weight", Stage::Parameters);
            let chi = sym(&a, "chi", &xyz, Stage::Parameters);
            let q = sym(&a, "attitude", &["w", "x", "y", "z"], Stage::Step);
            let m = sym(&a, "momentum", &xyz, Stage::Step);
            let g = sym(&a, "gamma", &xyz, Stage::Step);
            let so3 = catalogue()[0];
            let sys = System {
                algebra: Semidirect {
                    group: so3,
                    spaces: if free { vec![] } else { vec![so3.representations()[0]] },
                },
                inertia: Matrix::diagonal(&inertia),
                configuration: q,
                momentum: m,
                advected: if free { vec![] } else { vec![("gamma".into(), g.clone())] },
                potential: if free { a.zero() } else { weight * g.dot(&chi) },
            };
            let st = lie_poisson::step(&a, &sys, r, Number::ZERO);
            let k = Kernel::new(&a, &st);
            println!("==== free={free} {r:?}\n{k}");
        }
    }
}
