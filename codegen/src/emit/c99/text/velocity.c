/* The velocity that belongs to the momentum, by Newton's method from rest. A correction that leads to where nothing is defined is halved; the
 * iteration ends when no component's correction becomes smaller. */
U_FN S_status S_velocity(const S_parameters *parameters, const S_state *state MORE, REAL *velocity)
{
    REAL at[TWICE], there[TWICE], trial[DIMENSION], size, of;
    double last[DIMENSION], scale, largest = 0, correction = 0;
    int i, round, ended, is_defined;
    for (i = 0; i < DIMENSION; i++) {
        velocity[i] = ZERO;
        last[i] = U_LARGEST_DOUBLE;
    }
    S_velocity_newton(parameters, state HERE, at);
    for (round = 0; round < 100; round++) {
        ended = 1;
        for (i = 0; i < DIMENSION; i++) {
            size = FABS(at[DIMENSION + i]);
            of = FABS(velocity[i]);
            ended &= (double)size <= 2.0 * (double)U_EPSILON * (double)of
                || ((double)size <= 1e-10 * (double)of && (double)size >= 0.5 * last[i]);
        }
        if (ended)
            return U_OK;
        for (i = 0; i < DIMENSION; i++)
            last[i] = (double)FABS(at[DIMENSION + i]);
        is_defined = 0;
        for (scale = 1; scale > (double)U_EPSILON && !is_defined; scale *= 0.5) {
            for (i = 0; i < DIMENSION; i++)
                trial[i] = velocity[i] - (REAL)scale * at[DIMENSION + i];
            S_velocity_newton(parameters, state THERE, there);
            is_defined = 1;
            for (i = 0; i < TWICE; i++)
                is_defined &= S_is_finite(there[i]);
        }
        if (!is_defined)
            return U_NO_VELOCITY;
        for (i = 0; i < DIMENSION; i++)
            velocity[i] = trial[i];
        for (i = 0; i < TWICE; i++)
            at[i] = there[i];
    }
    for (i = 0; i < DIMENSION; i++) {
        correction = (double)FABS(at[DIMENSION + i]) > correction ? (double)FABS(at[DIMENSION + i]) : correction;
        largest = (double)FABS(velocity[i]) > largest ? (double)FABS(velocity[i]) : largest;
    }
    return correction <= 1e-4 * largest ? U_OK : U_NO_VELOCITY;
}

