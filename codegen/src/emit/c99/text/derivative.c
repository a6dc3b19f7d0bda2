/* The derivatives of a step, column by column: `wrt_state[j][i]` is how component i of the perturbation of the next state depends on component j
 * of that of the state. A configuration is perturbed by an element of the algebra, DISPLACED. The components, in order:
//each perturbed
 *     QUANTITY: RANGE
//end
 */
typedef struct {
    REAL wrt_state[PERTURBATIONS][PERTURBATIONS];
//if wrt_control
    REAL wrt_control[CONTROLS][PERTURBATIONS];
//end
//if wrt_parameters
    REAL wrt_parameters[PARAMETERS][PERTURBATIONS];
//end
} S_derivative;

/* That of no step. */
U_FN void S_derivative_clear(S_derivative *d)
{
    int i, j;
    for (i = 0; i < PERTURBATIONS; i++) {
        for (j = 0; j < PERTURBATIONS; j++)
            d->wrt_state[j][i] = i == j ? ONE : ZERO;
//if wrt_control
        for (j = 0; j < CONTROLS; j++)
            d->wrt_control[j][i] = ZERO;
//end
//if wrt_parameters
        for (j = 0; j < PARAMETERS; j++)
            d->wrt_parameters[j][i] = ZERO;
//end
    }
}

U_FN int S_derivative_is_finite(const S_derivative *d)
{
    int i, j, is_finite = 1;
    for (i = 0; i < PERTURBATIONS; i++) {
        for (j = 0; j < PERTURBATIONS; j++)
            is_finite &= S_is_finite(d->wrt_state[j][i]);
//if wrt_control
        for (j = 0; j < CONTROLS; j++)
            is_finite &= S_is_finite(d->wrt_control[j][i]);
//end
//if wrt_parameters
        for (j = 0; j < PARAMETERS; j++)
            is_finite &= S_is_finite(d->wrt_parameters[j][i]);
//end
    }
    return is_finite;
}

