/* A solution of a step's equation, or what has become of the search for it. */
typedef struct {
    /* where the equation was evaluated the last time, and the unknown, so near to that that it makes no difference */
    REAL point[SIZE], unknown[SIZE];
    K_evaluation evaluation;
    int solved, iterations;
    /* what is left, relative to the equation's terms, and the factor by which iterations contract */
    REAL residual, rate;
} K_solution;

/* Whether no block changes by more than the tolerance times its size: without a division, which takes long. */
U_HOT int K_is_within(const REAL *from, const REAL *to, REAL tolerance)
{
    REAL change, size;
    int i, is_within = 1;
//each block
    change = ZERO;
    size = ZERO;
    for (i = BEGIN; i < END; i++) {
        change += FABS(to[i] - from[i]);
        size += FABS(to[i]);
    }
    is_within &= change <= tolerance * size;
//end
    return is_within;
}

/* Whether each block of one is no larger than that of the other, which is finite. */
U_FN int K_is_below(const REAL *of, const REAL *bound)
{
    REAL size, most;
    int i, is_below = 1;
//each block
    size = ZERO;
    most = U_FLOOR;
    for (i = BEGIN; i < END; i++) {
        size += FABS(of[i]);
        most += FABS(bound[i]);
    }
    is_below &= size <= most && S_is_finite(most);
//end
    return is_below;
}

/* The blocks that are larger; the others are zero. */
U_FN void K_beyond(const REAL *of, const REAL *bound, REAL *beyond)
{
    REAL size, most;
    int i;
//each block
    size = ZERO;
    most = U_FLOOR;
    for (i = BEGIN; i < END; i++) {
        size += FABS(of[i]);
        most += FABS(bound[i]);
    }
    for (i = BEGIN; i < END; i++)
        beyond[i] = size <= most && S_is_finite(most) ? ZERO : of[i];
//end
}

/* ---- What is remembered of earlier solutions: it saves time, and nothing else. ---- */

/* x[j], from the latest on. */
U_HOT const REAL *K_row(const K_memory *m, unsigned oldest, int j)
{
    return m->ring[(oldest + (unsigned)U_WINDOW - (unsigned)j) % (unsigned)U_WINDOW];
}

//if newton
/* The first approximation, and what solutions are apart from it. */
U_HOT void K_from_start(const REAL *start, const REAL *apart, REAL *sum)
{
    int i;
    for (i = 0; i < SIZE; i++)
        sum[i] = start[i] + apart[i];
}

/* What seven earlier solutions contribute to the one after the next, of the polynomial through eight. */
U_HOT void K_eighth(const K_memory *m, unsigned oldest, REAL *sum)
{
    const REAL *x2 = K_row(m, oldest, 1), *x3 = K_row(m, oldest, 2), *x4 = K_row(m, oldest, 3), *x5 = K_row(m, oldest, 4);
    const REAL *x6 = K_row(m, oldest, 5), *x7 = K_row(m, oldest, 6), *x8 = K_row(m, oldest, 7);
    REAL inner, outer;
    int i;
    for (i = 0; i < SIZE; i++) {
        inner = U_BINOMIAL_2 * (x3[i] + x5[i]) + U_BINOMIAL_3 * x4[i];
        outer = U_BINOMIAL_1 * (x2[i] + x6[i]) + U_BINOMIAL_0 * x7[i];
        sum[i] = inner + (outer - x8[i]);
    }
}

//else
//if long
/* The weights of differences: usual ones, or those for slow motion. */
U_HOT const REAL *K_weights(int is_calm)
{
    U_TABLE REAL weights[2][5] = { { U_WEIGHTS_0, U_WEIGHTS_1, U_WEIGHTS_2, U_WEIGHTS_3, U_WEIGHTS_4 },
                                   { U_CALM_0, U_CALM_1, U_CALM_2, U_CALM_3, U_CALM_4 } };
    return weights[is_calm];
}

//end
/* x[16] - w[1] x[15] + the sum of w[j] (x[j] - x[16-j]), where the x[j] are as many places newer as it is ahead. */
U_HOT void K_earlier(const K_memory *m, unsigned oldest, int ahead, REAL *sum)
{
    const REAL *x2 = K_row(m, oldest, 2 - ahead), *x14 = K_row(m, oldest, 14 - ahead);
    const REAL *x3 = K_row(m, oldest, 3 - ahead), *x13 = K_row(m, oldest, 13 - ahead);
    const REAL *x5 = K_row(m, oldest, 5 - ahead), *x11 = K_row(m, oldest, 11 - ahead);
    const REAL *x7 = K_row(m, oldest, 7 - ahead), *x9 = K_row(m, oldest, 9 - ahead);
    const REAL *x15 = K_row(m, oldest, 15 - ahead), *x16 = K_row(m, oldest, 16 - ahead);
//if long
    const REAL *const w = K_weights(m->count > U_WINDOW);
//end
    REAL inner, outer, last;
    int i;
    for (i = 0; i < SIZE; i++) {
//if long
        inner = w[4] * (x7[i] - x9[i]) + w[3] * (x5[i] - x11[i]);
        outer = w[2] * (x3[i] - x13[i]) + w[1] * (x2[i] - x14[i]);
        last = x16[i] + -w[0] * x15[i];
//else
        inner = U_WEIGHTS_4 * (x7[i] - x9[i]) + U_WEIGHTS_3 * (x5[i] - x11[i]);
        outer = U_WEIGHTS_2 * (x3[i] - x13[i]) + U_WEIGHTS_1 * (x2[i] - x14[i]);
        last = x16[i] + -U_WEIGHTS_0 * x15[i];
//end
        sum[i] = last + (inner + outer);
    }
}

//end
/* The next solution from the polynomial through so many of the latest. */
U_FN void K_polynomial(const K_memory *m, int points, REAL *sum)
{
    U_TABLE REAL reciprocal[U_THROUGH] = { RECIPROCALS };
    REAL weight = -ONE;
    const REAL *row;
    int i, j;
    for (i = 0; i < SIZE; i++)
        sum[i] = ZERO;
    for (j = 1; j <= U_THROUGH && j <= points; j++) {
        weight = weight * ((REAL)(j - 1 - points) * reciprocal[j - 1]);
        row = K_row(m, m->oldest, j);
        for (i = 0; i < SIZE; i++)
            sum[i] += weight * row[i];
    }
}

/* Predicts the next solution. */
U_FN void K_predict(K_memory *m)
{
    const REAL *latest = K_row(m, m->oldest, 1);
    int i;
    if (m->count < FULL) {
        K_polynomial(m, m->count < U_THROUGH ? m->count : U_THROUGH, m->next);
        return;
    }
//if newton
    K_eighth(m, m->oldest - 1u, m->next);
//else
    K_earlier(m, m->oldest, 0, m->next);
//end
    for (i = 0; i < SIZE; i++)
        m->next[i] = m->next[i] + FIRST_WEIGHT * latest[i];
}

U_FN REAL K_weighted(const REAL *weights, const REAL *from, const REAL *to)
{
    REAL size = ZERO;
    int i;
    for (i = 0; i < SIZE; i++)
        size += weights[i] * FABS(to[i] - from[i]);
    return size;
}

/* One over the size of its block for each component. */
U_FN void K_one_over_sizes(const REAL *solution, REAL *weights)
{
    REAL size;
    int i;
//each block
    size = U_FLOOR;
    for (i = BEGIN; i < END; i++)
        size += FABS(solution[i]);
    for (i = BEGIN; i < END; i++)
        weights[i] = ONE / size;
//end
}

//if long
/* How far from this solution all have pointed, with usual weights or those for slow motion. */
U_FN REAL K_off(K_memory *m, int is_calm, const REAL *sizes, const REAL *solution)
{
    const REAL *latest = K_row(m, m->oldest, 1);
    REAL next[SIZE];
    int i;
    m->count = U_WINDOW + is_calm;
    K_earlier(m, m->oldest, 0, next);
    for (i = 0; i < SIZE; i++)
        next[i] = next[i] + FIRST_WEIGHT * latest[i];
    return K_weighted(sizes, next, solution);
}

/* Chooses the weights that would have led nearer to this solution. */
U_FN void K_choose(K_memory *m, const REAL *solution)
{
    REAL sizes[SIZE], usual;
    K_one_over_sizes(solution, sizes);
    usual = K_off(m, 0, sizes, solution);
    m->count = K_off(m, 1, sizes, solution) < usual ? U_WINDOW + 1 : U_WINDOW;
}

//end
/* Takes one more solution. Where a few of the earlier ones predict it better than all, the others are forgotten. */
U_FN void K_learn_solution(const K_equation *q, K_memory *m, const REAL *solution)
{
    REAL weights[SIZE], by_few[SIZE], begun[SIZE], off;
    int i, known;
//if newton
    /* what is kept is what they are apart from the equations' first approximations */
    REAL start[SIZE], kept[SIZE], next[SIZE];
    K_start(q, start);
    for (i = 0; i < SIZE; i++)
        kept[i] = solution[i] + -start[i];
    K_copy(m->solution, solution);
    K_from_start(start, m->next, next);
//else
    const REAL *const kept = solution, *const next = m->next;
    (void)q;
//end
//if long
    if (m->count >= FULL)
        K_choose(m, solution);
//end
    if (m->count >= FULL && K_is_within(next, solution, U_SMALL * U_EPSILON)) {
//if newton
        K_eighth(m, m->oldest, begun);
//else
        K_earlier(m, m->oldest, 1, begun);
//end
        K_copy(m->ring[m->oldest++ % (unsigned)U_WINDOW], kept);
        for (i = 0; i < SIZE; i++)
            m->next[i] = begun[i] + FIRST_WEIGHT * kept[i];
        return;
    }
    K_one_over_sizes(solution, weights);
    off = K_weighted(weights, next, solution);
//if newton
    /* by one solution alone large steps are off by as much, and the motion shows by two */
    known = m->count < 2 || off <= U_LOST ? m->count : 0;
//else
    known = off <= U_LOST ? m->count : 0;
//end
    m->count = known < U_WINDOW ? known + 1 : known;
    if (known > U_LOW) {
        K_polynomial(m, U_LOW, by_few);
//if newton
        K_from_start(start, by_few, by_few);
//end
        if (off > U_SMALL * U_EPSILON && K_weighted(weights, by_few, solution) < off)
            m->count = U_LOW;
    }
    K_copy(m->ring[m->oldest++ % (unsigned)U_WINDOW], kept);
    K_predict(m);
}

/* Whether the next step is likely to need one iteration. */
U_FN void K_settle(K_memory *m)
{
    m->is_ready = m->due > 0 && m->count >= FULL && m->rate <= U_STRONG;
}

U_FN void K_forget(K_memory *m)
{
    m->count = 0;
    m->due = U_INTERVALS_0;
    m->interval = U_INTERVALS_0;
    m->rate = U_STRONG;
    m->tolerance = U_TOLERANCE_0 * U_EPSILON;
    m->is_ready = 0;
}

/* Knows nothing yet. */
U_FN void K_clear(K_memory *m)
{
    int i, j;
    for (i = 0; i < SIZE; i++) {
        m->next[i] = ZERO;
//if newton
        m->solution[i] = ZERO;
//end
        for (j = 0; j < U_WINDOW; j++)
            m->ring[j][i] = ZERO;
    }
    m->oldest = 0;
    m->iterations = 0;
    m->residual = ZERO;
    K_forget(m);
}

/* Remembers a step that needed more than one iteration. */
U_FN void K_learn(const K_equation *q, K_memory *m, const K_solution *s)
{
    m->iterations = s->iterations;
    m->residual = s->residual;
    if (m->count == 0 || s->rate != m->rate) {
        m->rate = s->rate;
        m->tolerance = K_tolerance(s->rate);
    }
    if (m->due == 0) {
        m->due = m->interval;
        m->interval = 4 * m->interval < U_INTERVALS_1 ? 4 * m->interval : U_INTERVALS_1;
    } else {
        m->due--;
    }
    K_learn_solution(q, m, s->unknown);
    K_settle(m);
}

/* Where the search for a solution begins. */
U_FN void K_guess(const K_equation *q, const K_memory *m, REAL *guess)
{
//if newton
    K_start(q, guess);
    if (m->count > 0 && m->due > 0)
        K_from_start(guess, m->next, guess);
//else
    if (m->count == 0)
        K_start(q, guess);
//if update
    else if (m->due == 0)
        K_copy(guess, K_row(m, m->oldest, 1));
//end
    else
        K_copy(guess, m->next);
//end
}

/* Whether Newton's method leads to this solution from the equation's first approximation, too. Where steps are so large that the equation has
 * several solutions, which of them a step takes must not depend on what is remembered. */
U_FN int K_is_found_from_start(const K_equation *q, const REAL *solution)
{
    REAL start[SIZE], correction[SIZE], away;
    K_evaluation e;
    int i;
    K_start(q, start);
    away = K_change(start, solution);
    if (away <= U_NEAR)
        return 1;
    K_evaluate(q, start, &e);
    K_correction(q, start, &e, correction);
    for (i = 0; i < SIZE; i++)
        start[i] = start[i] - correction[i];
    return K_change(start, solution) <= U_TOWARDS * away;
}

//if update
/* ---- Fixed-point iterations, as long as they contract strongly. ---- */

/* What is left after a change. */
U_HOT REAL K_left(REAL rate, REAL change)
{
//if quadratic
    return rate * change * change;
//else
    return rate * change;
//end
}

//if newton
/* Whether a change, after another one, leaves no more than rounding, as far as the rate shows. */
U_HOT int K_is_left(REAL now, REAL last)
{
//if quadratic
    return now * now * now <= (U_LEFT * U_EPSILON) * last * last;
//else
    return now * now <= (U_LEFT * U_EPSILON) * last;
//end
}

/* A rate of convergence from two changes, one after the other, where another one was known. */
U_FN REAL K_rate(REAL last, REAL now, REAL known)
{
//if quadratic
    const REAL rate = now / (last * last), least = U_FORGETS * known;
//else
    const REAL rate = now / last, least = U_FORGETS * known;
//end
    return S_clamped(rate < least ? least : rate, LEAST_RATE, ONE);
}
//else
/* A rate of contraction from two changes, one after the other. */
U_FN REAL K_rate(REAL last, REAL now)
{
    return S_clamped(now / last, LEAST_RATE, ONE);
}
//end

/* The next iterate. */
U_HOT void K_next(const K_equation *q, const REAL *point, const K_evaluation *e, REAL *next)
{
//if quadratic
    int i;
    K_correction(q, point, e, next);
    for (i = 0; i < SIZE; i++)
        next[i] = point[i] - next[i];
//else
    K_fixed_point_update(q, point, e, next);
//end
}

/* From a guess; `first` is where the first iteration led to, if it was made. */
U_FN void K_iterate(const K_equation *q, const K_memory *m, const REAL *guess, const REAL *first, K_solution *s)
{
    REAL sharp_last = ONE, sharp_now = m->rate, last = U_FAR, now, most;
    REAL next[SIZE];
    int round = 0, again = 1, is_last;
//if newton
    /* as on the fast path, with its rate */
    const int is_as_fast = m->count >= FAST_FROM && m->due > 0;
    int measures = !is_as_fast;
//end
    K_copy(s->unknown, guess);
    s->solved = 0;
    s->iterations = 0;
    s->residual = ZERO;
    if (first) {
        K_copy(s->unknown, first);
        round = 1;
        s->iterations = 1;
        last = K_change(guess, first);
        s->solved = K_is_within(guess, first, m->tolerance);
        s->residual = m->tolerance;
        again = !s->solved;
    }
    for (;;) {
        K_copy(s->point, s->unknown);
        K_evaluate(q, s->point, &s->evaluation);
        K_next(q, s->point, &s->evaluation, next);
        K_copy(s->unknown, next);
        round++;
        s->iterations += again;
        now = K_change(s->point, s->unknown);
//if newton
        if (is_as_fast) {
            is_last = again && now <= m->tolerance && K_is_left(now, last);
            if (round > 1 && again && SHOWS && (U_TOLERANCE_0 * U_EPSILON < now || ONE <= sharp_last)) {
                sharp_last = last;
                sharp_now = now;
            }
        } else
//end
        if (round == 1) {
            is_last = again && K_is_within(s->point, s->unknown, m->tolerance);
        } else {
//if newton
            /* what is below is rounding, and no rate where there is another one */
            if (again && SHOWS && (U_TOLERANCE_0 * U_EPSILON < now || ONE <= sharp_last)) {
//else
            if (again && U_SHARP * U_EPSILON < last) {
//end
                sharp_last = last;
                sharp_now = now;
            }
//if newton
            most = K_tolerance(K_rate(sharp_last, sharp_now, m->rate));
//else
            most = U_TOLERANCE_2 * U_EPSILON;
//end
            is_last = again && (now <= U_TOLERANCE_0 * U_EPSILON || (now <= most && sharp_now <= U_QUICK * sharp_last));
        }
//if finds_any
        if (is_last && !K_is_found_from_start(q, s->unknown)) {
            /* it may be another solution */
            is_last = 0;
            again = 0;
        }
//end
        s->solved |= is_last;
        if (is_last)
            s->residual = now;
        again = again && !is_last && round < U_ITERATIONS;
//if newton
        again = again && ((is_as_fast && round <= U_FEW) || now <= U_STRONG * last);
        if (round == U_FEW + 1)
            measures = measures || again;
//else
        again = again && now <= U_STRONG * last;
//end
        if (!again)
            break;
        last = now;
    }
//if newton
    s->rate = measures ? K_rate(sharp_last, sharp_now, m->rate) : m->rate;
//else
    s->rate = K_rate(sharp_last, sharp_now);
//end
    s->residual = K_left(s->rate, s->residual);
}

//end
/* ---- Newton's method. ---- */

/* From a guess on, after iterations that count; it is one from `elsewhere` if the equation's own first approximation may lead to another solution. */
U_FN void K_newton(const K_equation *q, const REAL *from, int elsewhere, REAL rate, K_solution *s)
{
    REAL correction[SIZE], last = U_FAR, moved = ONE, now;
    int i, round = 0, done, stalls;
    REAL rounding[SIZE];
    K_copy(s->point, from);
    s->rate = rate;
    for (;;) {
        K_evaluate(q, s->point, &s->evaluation);
        now = K_relative(s->evaluation.residual, s->evaluation.right);
        done = K_is_rounding(now, moved);
        s->residual = now;
        stalls = !done && !(now <= U_PROGRESS * last);
        if (stalls) {
            K_roundoff(q, s->point, rounding);
            done = K_is_below(s->evaluation.residual, rounding);
            s->residual = U_EPSILON * K_relative(s->evaluation.residual, rounding);
        }
        if (done || stalls || round >= U_REGULAR)
            break;
        K_correction(q, s->point, &s->evaluation, correction);
        last = now;
        moved = K_relative(correction, s->point);
        for (i = 0; i < SIZE; i++)
            s->point[i] = s->point[i] - correction[i];
        round++;
        s->iterations++;
    }
    s->solved = done && (!elsewhere || K_is_found_from_start(q, s->point));
    K_copy(s->unknown, s->point);
}

/* ---- What is done for a step that neither iterations nor Newton's method solve, from nothing that is remembered. ---- */

/* A solution, what is left of its terms, and how many evaluations it took. */
typedef struct {
    REAL unknown[SIZE], residual;
    int evaluations;
} K_rescued;

/* The equation, and Newton's correction: for the residual there, or for the one that is given. */
U_FN void K_corrected(const K_equation *q, const REAL *unknown, const REAL *residual, K_evaluation *e, REAL *correction)
{
    K_evaluate(q, unknown, e);
    if (residual)
        K_copy(e->residual, residual);
    K_correction(q, unknown, e, correction);
}

/* Whether two solutions are one, but for what rounding leaves of the residual. */
U_FN int K_is_same(const K_equation *q, const REAL *a, const REAL *b)
{
    REAL rounding[SIZE], bound[SIZE];
    K_evaluation e;
    int i;
    K_roundoff(q, a, rounding);
    K_corrected(q, a, rounding, &e, bound);
    for (i = 0; i < SIZE; i++) {
        bound[i] = U_ROUNDINGS * FABS(bound[i]) + U_APART * FABS(a[i]);
        rounding[i] = a[i] - b[i];
    }
    return K_is_below(rounding, bound);
}

/* Whether a residual is what rounding leaves of its terms, and what is left of them. */
U_FN int K_is_solved(const K_equation *q, const REAL *residual, const REAL *unknown, REAL *left)
{
    REAL rounding[SIZE];
    K_roundoff(q, unknown, rounding);
    *left = U_EPSILON * K_relative(residual, rounding);
    return K_is_below(residual, rounding);
}

/* The equation at an unknown with Newton's correction for the blocks of its residual that are more than what rounding leaves of their terms, and
 * these. A correction for the others would be one at random, and it is the next residual of those that depend on what it changes. */
U_FN void K_corrected_beyond(const K_equation *q, const REAL *unknown, K_evaluation *e, REAL *beyond, REAL *correction)
{
    REAL residual[SIZE], rounding[SIZE];
    K_evaluate(q, unknown, e);
    K_copy(residual, e->residual);
    K_roundoff(q, unknown, rounding);
    K_beyond(residual, rounding, beyond);
    K_corrected(q, unknown, beyond, e, correction);
    K_copy(e->residual, residual);
}

/* Newton's method with corrections that are halved where the residual does not become smaller; and whether none was. */
U_FN S_status K_damped(const K_equation *q, const REAL *start, K_rescued *to, int *is_direct)
{
    REAL terms[SIZE], trial[SIZE], correction[SIZE], newest[SIZE], rounding[SIZE], beyond[SIZE], best[SIZE];
    K_evaluation e;
    double scale = 1, now, most;
    int i, evaluations, is_first = 1;
    *is_direct = 0;
    K_roundoff(q, start, terms);
    if (!K_are_finite(terms)) {
        K_corrected(q, start, 0, &e, newest);
        now = (double)K_relative(e.residual, e.right);
        if (!(now <= 0))
            return now <= U_LARGEST_DOUBLE ? U_NO_SOLUTION : U_NOT_FINITE;
        *is_direct = 1;
        K_copy(to->unknown, start);
        to->residual = ZERO;
        to->evaluations = 1;
        return U_OK;
    }
    *is_direct = 1;
    K_copy(to->unknown, start);
    K_copy(trial, start);
    K_copy(correction, start);
    K_copy(best, start);
    for (evaluations = 1; evaluations <= U_DAMPED; evaluations++) {
        K_corrected_beyond(q, trial, &e, beyond, newest);
        if (K_is_solved(q, e.residual, trial, &to->residual)) {
            K_copy(to->unknown, trial);
            to->evaluations = evaluations;
            return U_OK;
        }
        /* the largest so far: at rest there are none in the beginning */
        K_roundoff(q, trial, rounding);
        for (i = 0; i < SIZE; i++)
            if (FABS(terms[i]) < FABS(rounding[i]) && S_is_finite(rounding[i]))
                terms[i] = rounding[i];
        now = (double)K_relative(beyond, terms);
        most = is_first ? U_LARGEST_DOUBLE : (double)K_relative(best, terms);
        /* near a solution, what becomes larger is what rounding of some unknowns leaves of terms of others that cancel */
        if (is_first ? now <= most : now < most || now < U_NEARLY) {
            K_copy(to->unknown, trial);
            K_copy(best, beyond);
            K_copy(correction, newest);
            scale = 1;
            is_first = 0;
            if (!S_is_finite(K_relative(correction, to->unknown))) {
                *is_direct = 0;
                return U_SINGULAR_JACOBIAN;
            }
        } else {
            scale = 0.5 * scale;
            *is_direct = 0;
            if (!(scale > U_SHORTEST))
                return U_NO_SOLUTION;
        }
        for (i = 0; i < SIZE; i++)
            trial[i] = to->unknown[i] + (REAL)-scale * correction[i];
    }
    *is_direct = 0;
    return U_NO_CONVERGENCE;
}

/* The solution to which Newton's method leads from there, after so many evaluations; whether there is one. */
U_FN int K_led(const K_equation *q, const REAL *from, int before, int is_part, int is_wandering, K_rescued *to)
{
    REAL correction[SIZE], less[SIZE], beyond[SIZE];
    K_evaluation e;
    double last = 0, moves;
    int i, evaluations;
    K_copy(to->unknown, from);
    for (evaluations = 1; evaluations <= U_WANDERING; evaluations++) {
        K_corrected_beyond(q, to->unknown, &e, beyond, correction);
        if (K_is_solved(q, e.residual, to->unknown, &to->residual)) {
            for (i = 0; i < SIZE; i++)
                less[i] = to->unknown[i] - from[i];
            to->evaluations = before + evaluations;
            return !is_part || (double)K_relative(less, to->unknown) <= U_STRIDE;
        }
        moves = (double)K_relative(correction, to->unknown);
        if (!((evaluations == 1 ? moves <= U_LARGEST_DOUBLE : moves < last) || moves <= U_ON_THE_WAY
              || (is_wandering && moves <= U_LARGEST_DOUBLE)))
            return 0;
        for (i = 0; i < SIZE; i++)
            to->unknown[i] = to->unknown[i] - correction[i];
        last = moves;
    }
    return 0;
}

/* The solution by continuation: of equations whose residuals at the first approximation are ever smaller parts of what it is there. */
U_FN int K_continued(const K_equation *q, const REAL *start, int parts, int is_wandering, K_rescued *to)
{
    REAL first[SIZE], unknown[SIZE], correction[SIZE], residual[SIZE];
    K_evaluation e;
    double last, moves, left;
    int i, part, is_first, evaluations = 1;
    K_evaluate(q, start, &e);
    K_copy(first, e.residual);
    K_copy(unknown, start);
    for (part = 1; part < parts; part++) {
        left = 1.0 - (double)part / (double)parts;
        last = 0;
        is_first = 1;
        do {
            K_evaluate(q, unknown, &e);
            for (i = 0; i < SIZE; i++)
                residual[i] = e.residual[i] + (REAL)-left * first[i];
            K_corrected(q, unknown, residual, &e, correction);
            moves = (double)K_relative(correction, unknown);
            evaluations++;
            if (!((is_first ? moves <= U_LARGEST_DOUBLE : moves < last) || moves <= U_ON_THE_WAY)
                || evaluations > U_EVALUATIONS * parts)
                return 0;
            for (i = 0; i < SIZE; i++)
                unknown[i] = unknown[i] - correction[i];
            last = moves;
            is_first = 0;
        } while (!(moves <= U_ON_THE_WAY));
    }
    return K_led(q, unknown, evaluations, parts > 1, is_wandering, to);
}

/* By the coarsest of paths that leads somewhere, each in so many times as many parts. */
U_FN int K_by_path(const K_equation *q, const REAL *start, int times, int is_wandering, K_rescued *to)
{
    return K_continued(q, start, times * U_PARTS_0, is_wandering, to) || K_continued(q, start, times * U_PARTS_1, is_wandering, to)
        || K_continued(q, start, times * U_PARTS_2, is_wandering, to) || K_continued(q, start, times * U_PARTS_3, is_wandering, to);
}

/* The solution to which Newton's method and a path in many parts both lead, wherever corrections lead between. */
U_FN int K_agreed(const K_equation *q, const REAL *start, K_rescued *to)
{
    K_rescued continued;
    return K_led(q, start, 0, 0, 1, to) && K_by_path(q, start, 4, 1, &continued) && K_is_same(q, to->unknown, continued.unknown);
}

U_COLD S_status K_rescue(const K_equation *q, K_rescued *to)
{
    REAL start[SIZE];
    K_rescued continued;
    S_status status;
    int is_direct;
    K_start(q, start);
    status = K_damped(q, start, to, &is_direct);
    if (status == U_OK && is_direct)
        return U_OK;
    if (K_by_path(q, start, 1, 0, &continued)) {
        if (status == U_OK && !K_is_same(q, to->unknown, continued.unknown))
            return K_agreed(q, start, to) ? U_OK : U_SEVERAL_SOLUTIONS;
        *to = continued;
        return U_OK;
    }
    if (status == U_OK || K_agreed(q, start, to))
        return U_OK;
    return status;
}

/* ---- A step. ---- */

/* Where a step leads to from the solution of its equation; whether nothing is wrong. */
U_FN int K_accept(const K_equation *q, const K_solution *s, int given, S_state *next, int *inside)
{
    K_finish(q, s->unknown, &s->evaluation, next);
//if domain
    *inside = K_domain(q, s->unknown, &s->evaluation) > 0;
//else
    *inside = 1;
//end
    return s->solved && *inside && given && S_state_is_finite(next);
}

/* Solves the equation by iterations and Newton's method, from where the solutions before point; whether a step can be taken. */
U_FN int K_solve(const K_equation *q, const K_memory *m, const REAL *first, int given, K_solution *s, S_state *next, int *inside)
{
    REAL guess[SIZE], rate = m->rate;
    int elsewhere = m->count > 0;
    K_guess(q, m, guess);
//if update
    if (rate <= U_STRONG || m->due == 0) {
        K_iterate(q, m, guess, first, s);
        if (s->solved && K_accept(q, s, given, next, inside))
            return 1;
//if finds_any
        /* what Newton's method contracts to may be any solution, and it may have come to it */
        K_copy(guess, s->unknown);
//end
//if newton
//else
        elsewhere = elsewhere && !(rate <= U_STRONG);
//end
        rate = s->rate;
    } else {
        s->solved = 0;
        s->iterations = 0;
    }
    if (!s->solved)
//else
    (void)first;
    s->iterations = 0;
//end
        K_newton(q, guess, elsewhere, rate, s);
    return K_accept(q, s, given, next, inside);
}

/* A step, with all that can happen. The state is `known` if it is the one that the last step led to; `first` is where a first iteration led to. */
SLOW S_status K_slow(const K_constants *k, K_memory *m, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, const REAL *first, S_state *next)
{
    K_equation q;
    K_solution s;
    K_rescued rescued;
    REAL rate, tolerance;
    int given, inside, taken, count, due, interval, is_ready;
    S_status status;
    if (!known)
        K_forget(m);
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    /* what of these is not finite is not finite after the step either */
    given = GIVEN;
    taken = K_solve(&q, m, first, given, &s, next, &inside);
    if (!s.solved && m->count > 0) {
        /* once more as if nothing were remembered: what is hard to solve is solved as in a first step */
        rate = m->rate;
        tolerance = m->tolerance;
        count = m->count;
        due = m->due;
        interval = m->interval;
        is_ready = m->is_ready;
        K_forget(m);
        taken = K_solve(&q, m, 0, given, &s, next, &inside);
        m->rate = rate;
        m->tolerance = tolerance;
        m->count = count;
        m->due = due;
        m->interval = interval;
        m->is_ready = is_ready;
    }
    if (taken) {
        K_learn(&q, m, &s);
        return U_OK;
    }
    if (!given || !S_state_is_finite(x)) {
        K_forget(m);
        return U_NOT_FINITE;
    }
    status = K_rescue(&q, &rescued);
    s.solved = status == U_OK;
    if (s.solved) {
        K_copy(s.unknown, rescued.unknown);
        s.residual = rescued.residual;
        s.iterations = rescued.evaluations;
    }
    K_copy(s.point, s.unknown);
    K_evaluate(&q, s.point, &s.evaluation);
    if (K_accept(&q, &s, given, next, &inside)) {
        K_learn(&q, m, &s);
        return U_OK;
    }
    K_forget(m);
    if (!s.solved)
        return status;
    return inside ? U_NOT_FINITE : U_OUTSIDE_DOMAIN;
}

//if update
/* What goes on from one step to the next on the fast path. */
typedef struct {
    REAL next[SIZE];
    unsigned oldest;
//if newton
    int more; /* iterations of the last step, beside one */
//end
} K_path;

/* A step as nearly all are: ITERATION, from where the solutions before it point, changes the unknown by little, and everything is finite.
 * Else nothing has changed: 1 where there was an iteration, which led to `unknown`, 2 where it leads nowhere. */
U_HOT int K_fast(const K_constants *k, K_memory *m, K_path *path, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, REAL *unknown, S_state *next)
{
    K_equation q;
    K_evaluation e;
    REAL then[SIZE];
    int i;
//if newton
    REAL start[SIZE], point[SIZE], kept[SIZE], last = U_FAR, now;
    int more = 0;
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    K_start(&q, start);
    K_from_start(start, path->next, point);
    for (;;) {
        K_evaluate(&q, point, &e);
        K_next(&q, point, &e, unknown);
        now = K_change(point, unknown);
        /* as far as the rate is known, and as far as it shows */
        if (now <= m->tolerance && K_is_left(now, last))
            break;
        if (more == U_FEW)
            return 2;
        K_copy(point, unknown);
        last = now;
        more++;
    }
//if finds_any
    if (!K_is_found_from_start(&q, unknown))
        return 2;
//end
    for (i = 0; i < SIZE; i++)
        kept[i] = unknown[i] + -start[i];
    K_eighth(m, path->oldest, then);
    for (i = 0; i < SIZE; i++)
        then[i] = then[i] + U_BINOMIAL_0 * kept[i];
//else
    const REAL *const kept = unknown;
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    K_evaluate(&q, path->next, &e);
    K_fixed_point_update(&q, path->next, &e, unknown);
    if (!K_is_within(path->next, unknown, m->tolerance))
        return 1;
    /* before what follows from this solution, for the next step waits for it */
    K_earlier(m, path->oldest, 1, then);
    for (i = 0; i < SIZE; i++)
        then[i] = then[i] + FIRST_WEIGHT * unknown[i];
//end
    K_finish(&q, unknown, &e, next);
//if domain
    if (!(K_domain(&q, unknown, &e) > 0 && ZERO * (SURELY) <= ZERO)) {
//else
    if (!(ZERO * (SURELY) <= ZERO)) {
//end
        /* nobody reads it, but compilers would put the prediction off, until after this, and keep all that it is made of in memory */
        K_copy(unknown, then);
        return 2;
    }
    K_copy(m->ring[path->oldest % (unsigned)U_WINDOW], kept);
    path->oldest++;
    K_copy(path->next, then);
//if newton
    K_copy(m->solution, unknown);
    path->more = more;
//end
    return 0;
}

U_HOT void K_enter(const K_memory *m, K_path *path)
{
    K_copy(path->next, m->next);
    path->oldest = m->oldest;
//if newton
    path->more = 0;
//end
}

/* Remembers so many steps that were on the fast path. */
U_HOT void K_leave(K_memory *m, const K_path *path, int steps)
{
    K_copy(m->next, path->next);
    m->oldest = path->oldest;
    m->due -= steps;
    m->is_ready = m->is_ready && m->due > 0;
    if (steps > 0) {
        m->iterations = TAKEN;
        m->residual = K_left(m->rate, m->tolerance);
    }
}

//end
U_HOT S_status K_advance(const K_constants *k, K_memory *m, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
//if update
    if (known && m->is_ready) {
        K_path path;
        REAL unknown[SIZE];
        int ended;
        K_enter(m, &path);
        ended = K_fast(k, m, &path, x TIMED_CALL CONTROL_CALL, unknown, next);
        K_leave(m, &path, !ended);
        if (!ended)
            return U_OK;
        return K_slow(k, m, x TIMED_CALL CONTROL_CALL, known, ended == 1 ? unknown : 0, next);
    }
//end
    return K_slow(k, m, x TIMED_CALL CONTROL_CALL, known, 0, next);
}

