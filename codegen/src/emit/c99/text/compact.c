/* ---- A step: fixed-point iterations while they contract, then Newton's method, from where earlier solutions point. ---- */

U_FN void K_clear(K_memory *m)
{
    m->count = 0;
    m->rate = U_STRONG;
    m->iterations = 0;
    m->residual = ZERO;
}

U_FN S_status K_advance(const K_constants *k, K_memory *m, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
    K_equation q;
    K_evaluation e;
    REAL z[SIZE], d[SIZE], now, last = U_FAR, moved = ONE, was;
    int i, j, given, iterations = 0, corrections = 0;
//if update
    int is_newton = 0;
//end
    S_status status = U_OK;
    if (!known)
        m->count = 0;
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    /* what of these is not finite is not finite after the step either */
    given = GIVEN;
    if (m->count == 0) {
        K_start(&q, z);
    } else {
        /* the polynomial through the latest solutions */
        for (i = 0; i < SIZE; i++) {
            z[i] = ZERO;
            for (j = 0; j < m->count; j++)
                z[i] += m->differences[j][i];
        }
    }
    for (;;) {
        K_evaluate(&q, z, &e);
//if update
        if (!is_newton) {
            K_fixed_point_update(&q, z, &e, d);
            now = K_change(z, d);
            K_copy(z, d);
            iterations++;
            if (iterations > 1 && last > U_SHARP * U_EPSILON)
                m->rate = S_clamped(now / last, LEAST_RATE, ONE);
            if (now <= K_tolerance(m->rate))
                break;
            is_newton = !(now <= U_STRONG * last) || iterations >= U_ITERATIONS;
            last = is_newton ? U_FAR : now;
            continue;
        }
//end
        now = K_relative(e.residual, e.right);
        /* the right side may be rounding and nothing else: corrections are down to that */
        if (K_is_rounding(now, moved) || (now > U_PROGRESS * last && moved <= COMPACT_STALL))
            break;
        if (corrections == CORRECTIONS || !S_is_finite(now)) {
            status = given && S_state_is_finite(x) ? U_NO_CONVERGENCE : U_NOT_FINITE;
            break;
        }
        K_correction(&q, z, &e, d);
        last = now;
        moved = K_relative(d, z);
        for (i = 0; i < SIZE; i++)
            z[i] -= d[i];
        corrections++;
    }
    K_finish(&q, z, &e, next);
    if (status == U_OK && !(given && S_state_is_finite(next)))
        status = U_NOT_FINITE;
//if domain
    if (status == U_OK && !(K_domain(&q, z, &e) > 0))
        status = U_OUTSIDE_DOMAIN;
//end
    if (status != U_OK) {
        m->count = 0;
        return status;
    }
    m->iterations = iterations + corrections;
    m->residual = now;
    for (i = 0; i < SIZE; i++)
        for (j = 0; j < REMEMBERED; j++) {
            was = m->differences[j][i];
            m->differences[j][i] = z[i];
            z[i] -= was;
        }
    m->count += m->count < REMEMBERED;
    return U_OK;
}

