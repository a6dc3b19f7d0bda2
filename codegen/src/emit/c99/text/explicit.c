/* ---- A step, which is explicit. ---- */

U_HOT S_status K_advance(const K_constants *k, K_memory *m, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
    K_equation q;
    K_evaluation e;
    int given, inside = 1;
    (void)known;
    m->iterations = 0;
    m->residual = ZERO;
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    K_evaluate(&q, 0, &e);
    K_finish(&q, 0, &e, next);
    given = GIVEN;
//if domain
    inside = K_domain(&q, 0, &e) > 0;
//end
    if (given && inside && S_state_is_finite(next))
        return U_OK;
    return !given || !S_state_is_finite(x) || inside ? U_NOT_FINITE : U_OUTSIDE_DOMAIN;
}

U_FN void K_clear(K_memory *m)
{
    m->iterations = 0;
    m->residual = ZERO;
}

