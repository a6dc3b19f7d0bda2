//each array
/* From and to LENGTH numbers in a row, in the order in which the library's tables have them. */
U_FN void S_STRUCT_from(S_STRUCT *to, const REAL *numbers)
{
//each component
    to->PLACE = numbers[COMPONENT];
//end
}

U_FN void S_STRUCT_to(REAL *numbers, const S_STRUCT *from)
{
//each component
    numbers[COMPONENT] = from->PLACE;
//end
}

//end
U_FN int S_is_finite(REAL x)
{
    return FABS(x) <= U_LARGEST;
}

U_FN REAL S_clamped(REAL x, REAL least, REAL most)
{
    x = most < x ? most : x;
    return x < least ? least : x;
}

//if minimum
/* The lesser of two numbers; the other one of one that is none. */
U_FN REAL S_min(REAL a, REAL b)
{
    return a < b || b != b ? a : b;
}

//end
U_FN int S_state_is_finite(const S_state *x)
{
    if (S_is_finite(STATE_SUM))
        return 1;
    /* the sum may be too large */
    return STATE_FINITE;
}

//if control
U_FN int S_control_is_finite(const S_control *u)
{
    return CONTROL_FINITE;
}

//end
/* Whether a state that comes from elsewhere is one: finite, and nearly on its group. */
U_FN S_status S_check(const S_state *state)
{
    REAL off = ZERO, by;
//if deviation
    REAL largest[1];
    S_deviation(state, largest);
    off = largest[0];
//end
//each rotation
    by = FABS(LENGTH - ONE);
    off = by > off || by != by ? by : off;
//end
    (void)by;
    (void)state;
    if (!S_is_finite(off))
        return U_NOT_FINITE;
    return off > DEVIATION ? U_NOT_ON_GROUP : U_OK;
}

/* Whether two states are the same. */
U_FN int S_is_same(const S_state *a, const S_state *b)
{
    return SAME;
}

/* Sets all numbers of a state to nothing: for compilers that do not see that it is not read before it is known. */
U_FN void S_clear(S_state *state)
{
//each place
    state->PLACE = 0;
//end
}

/* Takes a state over, number by number: to copy a structure there is an instruction that takes as long as half a step. */
U_FN void S_take(const S_state *from, S_state *to)
{
#ifdef __OPTIMIZE_SIZE__
    *to = *from;
#else
//each place
    to->PLACE = from->PLACE;
//end
#endif
}

//if symmetric
/* Whether a matrix equals its transpose, to 1e-6 of its largest entry; and then it is its symmetric part. */
U_FN int S_symmetrized(REAL *entries, int rows)
{
    double difference = 0, largest = 0, a, b;
    REAL mean;
    int i, j;
    for (i = 0; i < rows; i++)
        for (j = 0; j < rows; j++) {
            a = (double)entries[i * rows + j];
            b = (double)entries[j * rows + i];
            largest = fabs(a) > largest ? fabs(a) : largest;
            difference = fabs(a - b) > difference ? fabs(a - b) : difference;
        }
    if (!(difference <= 1e-6 * largest))
        return 0;
    for (i = 0; i < rows; i++)
        for (j = 0; j < i; j++) {
            mean = HALF * (entries[i * rows + j] + entries[j * rows + i]);
            entries[i * rows + j] = mean;
            entries[j * rows + i] = mean;
        }
    return 1;
}

//end
/* Whether parameters are those of a system that can move; inertias that are matrices become their symmetric parts. */
U_FN S_status S_validate(S_parameters *parameters)
{
//if pivots
    int i;
//end
    (void)parameters;
    if (!(PARAMETERS_FINITE))
        return U_PARAMETER_NOT_FINITE;
//each matrix
    if (!S_symmetrized(ENTRIES, ROWS))
        return U_NOT_SYMMETRIC;
//end
//each inertia
    {
        REAL pivots[ROWS];
        S_PIVOTS(parameters, pivots);
        for (i = 0; i < ROWS; i++)
            if (!(pivots[i] > 0))
                return U_NOT_POSITIVE_DEFINITE;
    }
//end
    return U_OK;
}

