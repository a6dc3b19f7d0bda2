"""An ensemble on the workers of Ray: a class with a method `map` is all that it takes."""

import ray

import coadjoint as co

top = co.systems.heavy_top.example


@ray.remote
def call(function, argument):
    return function(argument)


class Ray:
    """Maps a function on Ray's workers."""

    def map(self, function, arguments):
        function = ray.put(function)
        waiting = [call.remote(function, argument) for argument in arguments]
        while waiting:
            # whichever has ended: blocks are merged in any order
            done, waiting = ray.wait(waiting)
            yield ray.get(done[0])


def member(k, rng):
    return {"momentum": rng.normal([0, 0, 5], 0.1), "gamma": [0, 0, 1]}


def run(client):
    quantities = {"nutation": lambda sol: sol.y.gamma[..., 2], "energy": lambda sol: sol.energy}
    return top.ensemble(
        member, n=20_000, seed=1, t_span=60, step=0.01, every=1000, quantities=quantities, client=client
    )


if __name__ == "__main__":
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    known = run(Ray())
    for t, one in zip(known.t, known["nutation"]):
        print(f"t = {t:4.0f} s: {one.mean:.4f} ± {one.deviation:.4f}")
    here = run(None)
    are_same = all(one == other for name in known.keys() for one, other in zip(known[name], here[name]))
    print("the same bytes as in one process" if are_same else "OTHER bytes than in one process")
    ray.shutdown()
