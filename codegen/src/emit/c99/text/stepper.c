/* ==== ABOUT ==== */

/* What one TITLE is made of. */
typedef struct {
//each part
    L_constants NTH;
    L_memory NTH_memory;
//end
//if pair
    REAL half;
    int is_whole; /* both halves remember solutions of one and the same step */
//end
//if derivative
    REAL step_size;
//end
} X_part;

/* Takes steps of one size. The state that the last step led to, and solutions, are remembered: that saves time, and nothing else. */
typedef struct {
//if composed
    X_part parts[COUNT];
    int is_whole;
//else
    X_part part;
//end
    REAL step_size;
    S_state left;
    int knows_left;
//if derivative
    S_parameters parameters;
//end
} X_stepper;

U_FN void X_part_init(X_part *p, const S_parameters *parameters, REAL step_size)
{
//if pair
    p->half = HALF * step_size;
    p->is_whole = 0;
//end
//if derivative
    p->step_size = step_size;
//end
//each part
    L_new(&p->NTH, parameters, SHARE);
    L_clear(&p->NTH_memory);
//end
}

/* For these parameters and this step; one that is negative goes back in time. */
U_FN S_status X_init(X_stepper *s, const S_parameters *parameters, REAL step_size)
{
    S_parameters valid = *parameters;
    const S_status status = S_validate(&valid);
//if composed
    U_TABLE REAL gamma[COUNT] = { GAMMA };
    int i;
//end
    if (status != U_OK)
        return status;
    if (!S_is_finite(step_size) || !(step_size < 0 || step_size > 0))
        return U_BAD_STEP;
//if composed
    for (i = 0; i < COUNT; i++)
        X_part_init(&s->parts[i], &valid, step_size * gamma[i]);
    s->is_whole = 0;
//else
    X_part_init(&s->part, &valid, step_size);
//end
    s->step_size = step_size;
    s->knows_left = 0;
    S_clear(&s->left);
//if derivative
    s->parameters = valid;
//end
    return U_OK;
}

U_HOT S_status X_part_advance(X_part *p, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
//if pair
    S_state middle;
    S_status status;
    known = known && p->is_whole;
    p->is_whole = 0;
    status = L1_advance(&p->first, &p->first_memory, x TIMED_CALL CONTROL_CALL, known, &middle);
    if (status != U_OK)
        return status;
    status = L2_advance(&p->second, &p->second_memory, &middle TIMED_HALF CONTROL_CALL, known, next);
    p->is_whole = status == U_OK;
    return status;
//else
    return L1_advance(&p->first, &p->first_memory, x TIMED_CALL CONTROL_CALL, known, next);
//end
}

//if timed
/* When the step after so many starts: not accumulated, so that it does not drift. */
U_FN REAL X_clock(const X_stepper *s, REAL time, unsigned long steps)
{
    return (REAL)((double)time + (double)steps * (double)s->step_size);
}

//end
//if composed
U_FN S_status X_advance(X_stepper *s, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
//if timed
    U_TABLE REAL done[COUNT] = { DONE };
//end
    S_state at = *x;
    S_status status = U_OK;
    int i;
    known = known && s->is_whole;
    s->is_whole = 0;
    for (i = 0; i < COUNT && status == U_OK; i++) {
        status = X_part_advance(&s->parts[i], &at TIMED_PART CONTROL_CALL, known, next);
        if (status == U_OK)
            at = *next;
    }
    s->is_whole = status == U_OK;
    return status;
}

//else
U_HOT S_status X_advance(X_stepper *s, const S_state *x TIMED_ARGUMENT CONTROL_ARGUMENT, int known, S_state *next)
{
    return X_part_advance(&s->part, x TIMED_CALL CONTROL_CALL, known, next);
}

//end
/* One step, in place STARTS. If it cannot be taken, the state is as before. */
U_FN S_status X_step(X_stepper *s, S_state *state TIMED_ARGUMENT CONTROL_ARGUMENT)
{
    S_state next;
    const int known = s->knows_left && S_is_same(&s->left, state);
    S_status status = known ? U_OK : S_check(state);
    if (status != U_OK)
        return status;
    status = X_advance(s, state TIMED_CALL CONTROL_CALL, known, &next);
    if (status != U_OK)
        return status;
    S_take(&next, state);
    S_take(&next, &s->left);
    s->knows_left = 1;
    return U_OK;
}

/* So many steps, as many calls of X_step take them but faster. Where one cannot be taken, the state is the last one that was reached;
 * `taken` is how many were, and may be 0. */
U_FN S_status X_steps(X_stepper *s, S_state *state TIMED_ARGUMENT CONTROL_ARGUMENT, unsigned long count, unsigned long *taken)
{
    unsigned long done = 0;
    S_status status = U_OK;
//if fast
    S_state now = *state, next;
    X_part *const p = &s->part;
    int known = s->knows_left && S_is_same(&s->left, state);
    if (!known && count > 0)
        status = S_check(state);
    while (status == U_OK && done < count) {
        int ready = known && p->first_memory.is_ready, ended = 0, steps = 0;
//if pair
        ready = ready && p->is_whole && p->second_memory.is_ready;
//end
        if (ready) {
            /* many on the fast path, with what goes on from one to the next in registers */
            L1_path path;
            REAL unknown[SIZE_1];
            int until = p->first_memory.due;
//if pair
            L2_path second_path;
            REAL second_unknown[SIZE_2];
            S_state middle;
            int is_first_through = 0;
            until = p->second_memory.due < until ? p->second_memory.due : until;
            L2_enter(&p->second_memory, &second_path);
//end
            until = (unsigned long)until > count - done ? (int)(count - done) : until;
            L1_enter(&p->first_memory, &path);
            while (steps < until) {
//if pair
                ended = L1_fast(&p->first, &p->first_memory, &path, &now TIMED_NOW CONTROL_CALL, unknown, &middle);
                if (ended)
                    break;
                ended = L2_fast(&p->second, &p->second_memory, &second_path, &middle TIMED_THEN CONTROL_CALL, second_unknown, &next);
                is_first_through = ended != 0;
//else
                ended = L1_fast(&p->first, &p->first_memory, &path, &now TIMED_NOW CONTROL_CALL, unknown, &next);
//end
                if (ended)
                    break;
                S_take(&next, &now);
                steps++;
            }
//if pair
            L1_leave(&p->first_memory, &path, steps + is_first_through);
            L2_leave(&p->second_memory, &second_path, steps);
//else
            L1_leave(&p->first_memory, &path, steps);
//end
            done += (unsigned long)steps;
            steps = 0;
            if (!ended)
                continue;
            {
                /* copies, so that the fast path needs no addresses */
                S_state from = now, to;
                REAL first[SIZE_1];
                L1_copy(first, unknown);
//if pair
                p->is_whole = 0;
                if (is_first_through) {
                    REAL second[SIZE_2];
                    from = middle;
                    L2_copy(second, second_unknown);
                    status = L2_slow(&p->second, &p->second_memory, &from TIMED_THEN CONTROL_CALL, 1, ended == 1 ? second : 0, &to);
                } else {
                    S_state between;
                    status = L1_slow(&p->first, &p->first_memory, &from TIMED_NOW CONTROL_CALL, 1, ended == 1 ? first : 0, &between);
                    if (status == U_OK)
                        status = L2_advance(&p->second, &p->second_memory, &between TIMED_THEN CONTROL_CALL, 1, &to);
                }
                p->is_whole = status == U_OK;
//else
                status = L1_slow(&p->first, &p->first_memory, &from TIMED_NOW CONTROL_CALL, 1, ended == 1 ? first : 0, &to);
//end
                if (status != U_OK)
                    break;
                now = to;
            }
        } else {
            S_state from = now, to;
            status = X_advance(s, &from TIMED_NOW CONTROL_CALL, known, &to);
            if (status != U_OK)
                break;
            now = to;
        }
        known = 1;
        done++;
    }
    if (done > 0) {
        *state = now;
        s->left = now;
        s->knows_left = 1;
    }
//else
    S_state now = *state, next;
    int known = s->knows_left && S_is_same(&s->left, state);
    if (!known && count > 0)
        status = S_check(state);
    while (status == U_OK && done < count) {
        status = X_advance(s, &now TIMED_NOW CONTROL_CALL, known, &next);
        if (status != U_OK)
            break;
        S_take(&next, &now);
        known = 1;
        done++;
    }
    if (done > 0) {
        *state = now;
        s->left = now;
        s->knows_left = 1;
    }
//end
    if (taken)
        *taken = done;
    return status;
}

/* How many iterations the last step took, and what they left of its equation, relative to its terms. */
U_FN int X_iterations(const X_stepper *s)
{
//if composed
    int i, iterations = 0;
    for (i = 0; i < COUNT; i++)
//if pair
        iterations += s->parts[i].first_memory.iterations + s->parts[i].second_memory.iterations;
//else
        iterations += s->parts[i].first_memory.iterations;
//end
    return iterations;
//else
//if pair
    return s->part.first_memory.iterations + s->part.second_memory.iterations;
//else
    return s->part.first_memory.iterations;
//end
//end
}

//if derivative
/* One step, and its derivatives: they are those of one step alone. */
U_FN S_status X_step_with_derivative(X_stepper *s, S_state *state TIMED_ARGUMENT CONTROL_ARGUMENT, S_derivative *derivative)
{
    S_state at = *state, next;
    const int known = s->knows_left && S_is_same(&s->left, state);
    S_status status = known ? U_OK : S_check(state);
//if composed
//if timed
    U_TABLE REAL done[COUNT] = { DONE };
//end
//end
    int i;
    if (status != U_OK)
        return status;
    status = X_advance(s, state TIMED_CALL CONTROL_CALL, known, &next);
    if (status != U_OK)
        return status;
    /* once more through the states between, from the solutions that were found */
    S_derivative_clear(derivative);
    for (i = 0; i < COUNT; i++) {
//if composed
        X_part *const p = &s->parts[i];
//if timed
        const REAL from = time + done[i] * s->step_size;
//end
//else
        X_part *const p = &s->part;
//if timed
        const REAL from = time;
//end
//end
//if pair
        S_state middle;
        L1_follow(&p->first_memory, &s->parameters, p->half, &at TIMED_STAGE CONTROL_CALL, derivative);
        L1_replay(&p->first, &p->first_memory, &at TIMED_STAGE CONTROL_CALL, &middle);
        L2_follow(&p->second_memory, &s->parameters, p->half, &middle TIMED_STAGE_HALF CONTROL_CALL, derivative);
        L2_replay(&p->second, &p->second_memory, &middle TIMED_STAGE_HALF CONTROL_CALL, &at);
//else
        L1_follow(&p->first_memory, &s->parameters, p->step_size, &at TIMED_STAGE CONTROL_CALL, derivative);
        L1_replay(&p->first, &p->first_memory, &at TIMED_STAGE CONTROL_CALL, &at);
//end
    }
    if (!S_derivative_is_finite(derivative))
        return U_NO_DERIVATIVE;
    S_take(&next, state);
    S_take(&next, &s->left);
    s->knows_left = 1;
    return U_OK;
}

//end
