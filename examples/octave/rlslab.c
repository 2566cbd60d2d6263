/* rlslab.h from Octave (and MATLAB): mkoctfile --mex rlslab.c
 *
 *   f = rlslab('new', variant, arithmetic, size, options)   options: a struct with the members of rlslab_options
 *   [innovation, residual, gamma, health, signal] = rlslab('update', f, psi, y)
 *   x = rlslab('theta', f)    also 'gain', 'covariance', 'information', 'counts', 'save' (the state, in bytes)
 *   rlslab('load', f, state); rlslab('free', f); rlslab('reset', f)
 *   names = rlslab('names', list)                           list: 0 variants, 1 arithmetics ... as in rlslab.h
 *
 * f is a number: the filter's place in a table, so that a wrong one is an error. Filters are freed with the function. */
#include <mex.h>
#include <rlslab.h>

#include <stdlib.h>
#include <string.h>

static rlslab_filter** filters = NULL;
static size_t places = 0;

static void free_all(void) {
    size_t i;
    for (i = 0; i < places; ++i) rlslab_free(filters[i]);
    free(filters);
    filters = NULL;
    places = 0;
}

static void require(rlslab_status status) {
    if (status != RLSLAB_OK) mexErrMsgIdAndTxt("rlslab:error", "%s", rlslab_message());
}
static void require_that(int holds, char const* what) {
    if (!holds) mexErrMsgIdAndTxt("rlslab:error", "%s", what);
}
static int is_real(mxArray const* x) { return mxIsDouble(x) && !mxIsComplex(x) && !mxIsSparse(x); }

static double number(mxArray const* x, char const* what) {
    require_that(is_real(x) && mxGetNumberOfElements(x) == 1, what);
    return mxGetScalar(x);
}
static size_t count_of(mxArray const* x, char const* what) {
    double const value = number(x, what);
    require_that(value >= 0 && value < 9007199254740992.0 && value == (double)(size_t)value, what);
    return (size_t)value;
}
static char* text(mxArray const* x, char const* what) {
    require_that(mxIsChar(x), what);
    return mxArrayToString(x); /* freed by mex */
}
static rlslab_filter* filter_of(int count, mxArray const* arguments[]) {
    size_t place;
    require_that(count > 1, "the filter is missing");
    place = count_of(arguments[1], "a filter is a number");
    require_that(place >= 1 && place <= places && filters[place - 1], "there is no such filter");
    return filters[place - 1];
}

static mxArray* row_of_names(int list) {
    size_t count = 0, i;
    mxArray* out;
    while (rlslab_name(list, count)) ++count;
    out = mxCreateCellMatrix(1, count);
    for (i = 0; i < count; ++i) mxSetCell(out, i, mxCreateString(rlslab_name(list, i)));
    return out;
}

static void set_options(rlslab_options* o, mxArray const* from) {
    int i;
    require_that(mxIsStruct(from), "options are a struct");
    for (i = 0; i < mxGetNumberOfFields(from); ++i) {
        char const* const name = mxGetFieldNameByNumber(from, i);
        mxArray const* const x = mxGetFieldByNumber(from, 0, i);
        if (!strcmp(name, "forgetting")) o->forgetting = number(x, name);
        else if (!strcmp(name, "prior_variance")) o->prior_variance = number(x, name);
        else if (!strcmp(name, "prior_theta")) {
            require_that(is_real(x) && mxGetNumberOfElements(x) == o->size, "prior_theta: size numbers");
            o->prior_theta = mxGetPr(x);
        } else if (!strcmp(name, "prior_covariance")) {
            require_that(is_real(x) && mxGetM(x) == o->size && mxGetN(x) == o->size, "prior_covariance: size x size");
            o->prior_covariance = mxGetPr(x);
        } else if (!strcmp(name, "window")) o->window = count_of(x, name);
        else if (!strcmp(name, "guard")) o->guard = text(x, name);
        else if (!strcmp(name, "control")) o->control = text(x, name);
        else if (!strcmp(name, "control_numbers")) {
            require_that(is_real(x), name);
            o->control_numbers = mxGetPr(x);
            o->control_count = mxGetNumberOfElements(x);
        } else if (!strcmp(name, "largest_variance")) o->largest_variance = number(x, name);
        else if (!strcmp(name, "innovation")) o->innovation = number(x, name);
        else if (!strcmp(name, "least_noise")) o->least_noise = number(x, name);
        else if (!strcmp(name, "asymmetry")) o->asymmetry = number(x, name);
        else if (!strcmp(name, "noise_memory")) o->noise_memory = count_of(x, name);
        else if (!strcmp(name, "rebuild_rows")) o->rebuild_rows = count_of(x, name);
        else mexErrMsgIdAndTxt("rlslab:error", "no option \"%s\"", name);
    }
}
static mxArray* new_filter(int count, mxArray const* arguments[]) {
    rlslab_options options;
    rlslab_filter** grown;
    require_that(count == 4 || count == 5, "new: variant, arithmetic, size, options");
    require(rlslab_defaults(&options, sizeof options));
    options.size = count_of(arguments[3], "size is a number");
    if (count == 5) set_options(&options, arguments[4]);
    grown = realloc(filters, (places + 1) * sizeof *filters);
    require_that(grown != NULL, "out of memory");
    filters = grown;
    require(rlslab_new(text(arguments[1], "variant is a text"), text(arguments[2], "arithmetic is a text"), &options,
                       &filters[places]));
    mexAtExit(free_all);
    return mxCreateDoubleScalar((double)++places);
}

static mxArray* counts(rlslab_filter const* filter) {
    static char const* const names[] = {"rows",    "unusable",   "outliers", "changes",    "windups", "breakdowns",
                                        "refactored", "since", "handed_over"};
    rlslab_counts c;
    int64_t all[9];
    mxArray* out = mxCreateStructMatrix(1, 1, 9, (char const**)names);
    int i;
    require(rlslab_count(filter, &c, sizeof c));
    memcpy(all, &c, sizeof all);
    for (i = 0; i < 9; ++i) mxSetFieldByNumber(out, 0, i, mxCreateDoubleScalar((double)all[i]));
    return out;
}

static mxArray* numbers(rlslab_status (*get)(rlslab_filter const*, double*), rlslab_filter const* filter, int matrix) {
    size_t const d = rlslab_size(filter);
    mxArray* const out = mxCreateDoubleMatrix(d, matrix ? d : 1, mxREAL);
    require(get(filter, mxGetPr(out)));
    return out;
}

void mexFunction(int results, mxArray* result[], int count, mxArray const* argument[]) {
    char* verb;
    require_that(count > 0, "rlslab: a verb, see rlslab.c");
    verb = text(argument[0], "the verb is a text");
    if (!strcmp(verb, "new")) {
        result[0] = new_filter(count, argument);
    } else if (!strcmp(verb, "names")) {
        require_that(count == 2, "names: the list's number");
        result[0] = row_of_names((int)number(argument[1], "the list is a number"));
    } else if (!strcmp(verb, "update")) {
        rlslab_filter* const filter = filter_of(count, argument);
        rlslab_step step;
        double all[5];
        int i;
        require_that(count == 4 && is_real(argument[2]) && mxGetNumberOfElements(argument[2]) == rlslab_size(filter),
                     "update: a filter, as many numbers as it has parameters, a number");
        require(rlslab_update(filter, mxGetPr(argument[2]), number(argument[3], "y is a number"), &step));
        all[0] = step.innovation, all[1] = step.residual, all[2] = step.gamma, all[3] = step.health;
        all[4] = step.signal;
        for (i = 0; i < (results > 1 ? results : 1) && i < 5; ++i) result[i] = mxCreateDoubleScalar(all[i]);
    } else if (!strcmp(verb, "theta")) {
        result[0] = numbers(rlslab_theta, filter_of(count, argument), 0);
    } else if (!strcmp(verb, "gain")) {
        result[0] = numbers(rlslab_gain, filter_of(count, argument), 0);
    } else if (!strcmp(verb, "covariance")) {
        result[0] = numbers(rlslab_covariance, filter_of(count, argument), 1);
    } else if (!strcmp(verb, "information")) {
        result[0] = numbers(rlslab_information, filter_of(count, argument), 1);
    } else if (!strcmp(verb, "counts")) {
        result[0] = counts(filter_of(count, argument));
    } else if (!strcmp(verb, "save")) {
        rlslab_filter* const filter = filter_of(count, argument);
        size_t const size = rlslab_state_size(filter);
        result[0] = mxCreateNumericMatrix(1, size, mxUINT8_CLASS, mxREAL);
        require(rlslab_save(filter, mxGetData(result[0]), size));
    } else if (!strcmp(verb, "load")) {
        require_that(count == 3 && mxIsUint8(argument[2]), "load: a filter, a state in uint8");
        require(rlslab_load(filter_of(count, argument), mxGetData(argument[2]), mxGetNumberOfElements(argument[2])));
    } else if (!strcmp(verb, "reset")) {
        require(rlslab_reset(filter_of(count, argument)));
    } else if (!strcmp(verb, "free")) {
        rlslab_free(filter_of(count, argument));
        filters[(size_t)mxGetScalar(argument[1]) - 1] = NULL;
    } else {
        mexErrMsgIdAndTxt("rlslab:error", "no verb \"%s\"; see rlslab.c", verb);
    }
}
