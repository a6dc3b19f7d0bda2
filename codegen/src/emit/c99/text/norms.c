U_FN void K_copy(REAL *to, const REAL *from)
{
#ifdef __OPTIMIZE_SIZE__
    int i;
    for (i = 0; i < SIZE; i++)
        to[i] = from[i];
#else
//each unknown
    to[INDEX] = from[INDEX];
//end
#endif
}

/* The sum of |of|/|to| over blocks of one unit each. */
U_FN REAL K_relative(const REAL *of, const REAL *to)
{
    REAL ratios = ZERO, change, size;
    int i;
//each block
    change = ZERO;
    size = U_FLOOR;
    for (i = BEGIN; i < END; i++) {
        change += FABS(of[i]);
        size += FABS(to[i]);
    }
    ratios += change / size;
//end
    return ratios;
}

//if update|full
/* The change from one unknown to another, relative to this one. */
U_FN REAL K_change(const REAL *from, const REAL *to)
{
    REAL less[SIZE];
    int i;
    for (i = 0; i < SIZE; i++)
        less[i] = to[i] - from[i];
    return K_relative(less, to);
}

/* The relative change of an iteration that may be the last, where iterations contract by this factor. */
U_FN REAL K_tolerance(REAL rate)
{
//if quadratic
    return rate <= U_STRONG ? SQRT(U_NEWTON_0 * U_EPSILON / rate) : -ONE;
//else
//if newton
    const REAL units = S_clamped(U_NEWTON_0 / rate, U_TOLERANCE_0, U_NEWTON_1);
//else
    const REAL units = S_clamped(U_HARDLY / (rate * rate), U_TOLERANCE_0, U_TOLERANCE_1);
//end
    return rate <= U_STRONG ? U_EPSILON * units : -ONE;
//end
}

//end
/* Whether a residual is rounding, after a correction that moved the unknown by so much. */
U_FN int K_is_rounding(REAL residual, REAL moved)
{
    const REAL square = moved * moved;
    return residual <= U_RESIDUAL_0 * U_EPSILON || (residual <= U_RESIDUAL_2 * U_EPSILON && U_RESIDUAL_3 * square <= U_EPSILON)
//if true_jacobian
        || (residual <= U_RESIDUAL_4 * U_EPSILON && U_RESIDUAL_5 * square <= U_EPSILON)
//end
        ;
}

