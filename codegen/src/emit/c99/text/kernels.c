#if defined(__CUDACC__) || defined(__HIPCC__) || defined(U_MEMBER)
/* ==== Many members, a thread each: ABOUT ==== */

#ifndef U_MEMBER
#define U_KERNEL static __global__
#define U_MEMBER ((unsigned long)blockIdx.x * (unsigned long)blockDim.x + (unsigned long)threadIdx.x)
#endif

/* Takes `steps` steps of each of `members` members. Arrays are structures of arrays, so that threads beside each other read numbers beside each
 * other: component k of member i stands at [k * members + i], in the order of S_state_from and its like.
 *
 * `parameters` are each member's own, or, where `shared` is not zero, one set for all. `state` goes in and comes out. After every `every` steps
 * the state is written to `samples`, one state of all members after the other, if there is such an array.
//if control
 * `controls` are held for as many steps: one after the other for each of `intervals` intervals, the last one to the end.
//end
//if timed
 * The first step starts at `time`.
//end
 * `status` says how it went for each member; the state of one that failed is the last that it reached. */
U_KERNEL void X_ensemble(const REAL *parameters, int shared, REAL *state, REAL step_size TIMED_ARGUMENT CONTROL_ARRAY, unsigned long steps,
    unsigned long every, REAL *samples, int *status, unsigned long members)
{
    const unsigned long i = U_MEMBER;
    REAL numbers[MOST];
    S_parameters own;
    S_state x;
    X_stepper s;
    unsigned long done = 0, taken = 0, sample = 0, k, count;
    S_status how;
//if control
    S_control control;
//end
    if (i >= members)
        return;
    for (k = 0; k < PARAMETER_COUNT; k++)
        numbers[k] = parameters[shared ? k : k * members + i];
//if parameters
    S_parameters_from(&own, numbers);
//end
    for (k = 0; k < STATE_COUNT; k++)
        numbers[k] = state[k * members + i];
    S_state_from(&x, numbers);
    how = X_init(&s, &own, step_size);
    while (how == U_OK && done < steps) {
        count = every > 0 && every < steps - done ? every : steps - done;
//if control
        for (k = 0; k < CONTROL_COUNT; k++)
            numbers[k] = controls[((sample < intervals ? sample : intervals - 1) * CONTROL_COUNT + k) * members + i];
        S_control_from(&control, numbers);
//end
        how = X_steps(&s, &x TIMED_CHUNK CONTROL_POINTER, count, &taken);
        done += taken;
        if (how == U_OK && samples && done % (every > 0 ? every : steps) == 0) {
            S_state_to(numbers, &x);
            for (k = 0; k < STATE_COUNT; k++)
                samples[(sample * STATE_COUNT + k) * members + i] = numbers[k];
        }
        sample++;
    }
    S_state_to(numbers, &x);
    for (k = 0; k < STATE_COUNT; k++)
        state[k * members + i] = numbers[k];
    status[i] = (int)how;
}

#endif
