/* Where a step leads to, from the solution of its equation. */
U_FN void K_replay(const K_constants *k, const K_memory *m, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, S_state *next)
{
    K_equation q;
    K_evaluation e;
    (void)m;
    q.constants = k;
    q.state = x;
    K_begin(&q TIMED_CALL CONTROL_CALL);
    K_evaluate(&q, SOLUTION, &e);
    K_finish(&q, SOLUTION, &e, next);
}

/* The derivative of steps before this one, followed by this one: the chain rule. */
U_FN void K_follow(const K_memory *m, const S_parameters *parameters, REAL step_size, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, S_derivative *d)
{
    K_point point;
//if through
    REAL through[THROUGH][PERTURBATIONS];
//end
    REAL by_state[PERTURBATIONS][PERTURBATIONS], column[PERTURBATIONS];
    int i, j, k;
//if wrt_control
    REAL by_control[CONTROLS][PERTURBATIONS];
//end
//if wrt_parameters
    REAL by_parameters[PARAMETERS][PERTURBATIONS];
//end
    K_point_at(&point, parameters, step_size, x TIMED_CALL CONTROL_CALL, SOLUTION);
    (void)m;
//if through
    K_through(&point, through);
//end
    K_wrt_state(&point THROUGH_CALL, by_state);
//if wrt_control
    K_wrt_control(&point THROUGH_CALL, by_control);
    for (k = 0; k < CONTROLS; k++) {
        for (i = 0; i < PERTURBATIONS; i++)
            column[i] = by_control[k][i];
        for (j = 0; j < PERTURBATIONS; j++)
            for (i = 0; i < PERTURBATIONS; i++)
                column[i] += by_state[j][i] * d->wrt_control[k][j];
        for (i = 0; i < PERTURBATIONS; i++)
            d->wrt_control[k][i] = column[i];
    }
//end
//if wrt_parameters
    K_wrt_parameters(&point THROUGH_CALL, by_parameters);
    for (k = 0; k < PARAMETERS; k++) {
        for (i = 0; i < PERTURBATIONS; i++)
            column[i] = by_parameters[k][i];
        for (j = 0; j < PERTURBATIONS; j++)
            for (i = 0; i < PERTURBATIONS; i++)
                column[i] += by_state[j][i] * d->wrt_parameters[k][j];
        for (i = 0; i < PERTURBATIONS; i++)
            d->wrt_parameters[k][i] = column[i];
    }
//end
    for (k = 0; k < PERTURBATIONS; k++) {
        for (i = 0; i < PERTURBATIONS; i++)
            column[i] = ZERO;
        for (j = 0; j < PERTURBATIONS; j++)
            for (i = 0; i < PERTURBATIONS; i++)
                column[i] += by_state[j][i] * d->wrt_state[k][j];
        for (i = 0; i < PERTURBATIONS; i++)
            d->wrt_state[k][i] = column[i];
    }
}

