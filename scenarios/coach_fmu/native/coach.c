#include "coach.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TEXT 1200
#define PATIENCE_S 2.0
#define START_LIMIT_S 600.0 /* the first start on a machine compiles */
#define STEP_LIMIT_S 60.0   /* and a second for each second simulated */

static const char KINDS[] = VARIABLE_KINDS;
static const double STARTS[] = {VARIABLE_STARTS};

/* Frames: to the child a command and its argument, then all that the host sets. Back comes a header, then as many bytes
   as it says: the values that the host gets, or a text. */
enum { START = 0, STEP = 1, STOP = 2 };
enum { FINE = 0 };
typedef struct { double command, argument, set[SET]; } Request;
typedef struct { double status, size; } Header;

static bool fail(const Coach *coach, const char *form, ...)
{
    char text[TEXT];
    va_list arguments;
    va_start(arguments, form);
    vsnprintf(text, sizeof text, form, arguments);
    va_end(arguments);
    coach->log(coach, text);
    return false;
}

static double limit_s(double usual_s)
{
    const char *wanted = getenv("RAILSLIDE_TIMEOUT_S");
    double given_s = wanted ? atof(wanted) : 0.0;
    return given_s > 0.0 ? given_s : usual_s;
}

/* The Python to start, by this order; `recorded` keeps the path of the exporting one. */
static const char *choose_python(const Coach *coach, char *recorded, size_t size)
{
    const char *wanted = getenv("RAILSLIDE_PYTHON");
    if (wanted && *wanted)
        return wanted;
    char path[TEXT];
    snprintf(path, sizeof path, "%s/python.txt", coach->resources);
    FILE *file = fopen(path, "r");
    bool read = file && fgets(recorded, (int)size, file);
    if (file)
        fclose(file);
    if (read) {
        recorded[strcspn(recorded, "\r\n")] = '\0';
        if (access(recorded, X_OK) == 0)
            return recorded;
    }
    return "python3";
}

static bool start_child(Coach *coach)
{
    char recorded[TEXT];
    const char *python = choose_python(coach, recorded, sizeof recorded);
    /* -P: modules of the host's working folder are none of ours */
    char *arguments[] = {(char *)python, "-P", "-m", "scenarios.coach_fmu.server", coach->resources, NULL};
    coach->greeted = false;
    int failure = child_start(&coach->child, arguments);
    if (!failure)
        return true;
    return fail(coach,
        "this FMU needs a Python with railslide, and %s cannot be started (%s): set the environment variable "
        "RAILSLIDE_PYTHON to a Python in which railslide is installed", python, strerror(failure));
}

static bool lost(Coach *coach, ChildResult result, const char *doing, double waited_s)
{
    char line[TEXT / 2], fate[64];
    child_last_line(&coach->child, line, sizeof line);
    child_stop(&coach->child, result == CHILD_TIMED_OUT ? 0.0 : PATIENCE_S, fate, sizeof fate);
    coach->state = BROKEN;
    if (result == CHILD_TIMED_OUT)
        return fail(coach, "the coach's Python process gave no answer within %g s when %s (RAILSLIDE_TIMEOUT_S sets "
                           "the limit)%s%s", waited_s, doing, *line ? ": " : "", line);
    if (!coach->greeted)
        return fail(coach,
            "this FMU needs a Python with railslide, and the one that it found %s%s%s: set the environment variable "
            "RAILSLIDE_PYTHON to a Python (3.11 or later) in which railslide is installed", fate,
            *line ? ", saying: " : "", line);
    return fail(coach, "the coach's Python process %s when %s%s%s", fate, doing, *line ? ": " : "", line);
}

/* Receive an answer: `size` bytes into `data`, or a text, which is logged. */
static bool answer(Coach *coach, void *data, size_t size, double patience_s, const char *doing)
{
    Header header;
    ChildResult result = child_receive(&coach->child, &header, sizeof header, patience_s);
    if (result != CHILD_FINE)
        return lost(coach, result, doing, patience_s);
    if (header.status == FINE && header.size == (double)size) {
        result = child_receive(&coach->child, data, size, patience_s);
        return result == CHILD_FINE || lost(coach, result, doing, patience_s);
    }
    char text[TEXT];
    if (header.status == FINE || !(header.size >= 0.0 && header.size < TEXT)) {
        child_stop(&coach->child, 0.0, NULL, 0);
        coach->state = BROKEN;
        return fail(coach, "the railslide that this FMU found does not fit it: export the FMU anew from that one");
    }
    result = child_receive(&coach->child, text, (size_t)header.size, patience_s);
    if (result != CHILD_FINE)
        return lost(coach, result, doing, patience_s);
    text[(size_t)header.size] = '\0';
    return fail(coach, "%s", text);
}

static bool ask(Coach *coach, double command, double argument, void *data, size_t size, double patience_s,
                const char *doing)
{
    Request request = {command, argument, {0.0}};
    memcpy(request.set, coach->values, sizeof request.set);
    ChildResult result = child_send(&coach->child, &request, sizeof request);
    if (result != CHILD_FINE)
        return lost(coach, result, doing, patience_s);
    return answer(coach, data, size, patience_s, doing);
}

static void set_starts(Coach *coach)
{
    memcpy(coach->values, STARTS, sizeof coach->values);
    coach->state = INSTANTIATED;
    coach->start_s = 0.0;
    coach->ticks = 0;
}

Coach *coach_new(const Coach *like, const char *token)
{
    if (!token || strcmp(token, TOKEN) != 0) {
        fail(like, "the model description is not that of this library (GUID or instantiation token)");
        return NULL;
    }
    if (!like->resources) {
        fail(like, "no folder of resources was given as a local path or file URI");
        return NULL;
    }
    Coach *coach = malloc(sizeof *coach);
    if (!coach)
        return NULL;
    *coach = *like;
    coach->child = NO_CHILD;
    coach->name = strdup(like->name ? like->name : "");
    coach->resources = strdup(like->resources);
    set_starts(coach);
    if (coach->name && coach->resources && start_child(coach))
        return coach;
    coach_free(coach);
    return NULL;
}

void coach_free(Coach *coach)
{
    if (!coach)
        return;
    child_stop(&coach->child, PATIENCE_S, NULL, 0);
    free(coach->name);
    free(coach->resources);
    free(coach);
}

static bool is_in(const Coach *coach, CoachState state, const char *function)
{
    return coach->state == state || fail(coach, "%s: not in this state of the FMU", function);
}

bool coach_initialize(Coach *coach, double start_s)
{
    if (!is_in(coach, INSTANTIATED, "EnterInitializationMode"))
        return false;
    if (!isfinite(start_s))
        return fail(coach, "startTime = %g: must be finite", start_s);
    const double patience_s = limit_s(START_LIMIT_S);
    if (!coach->greeted) {
        char theirs[sizeof TOKEN] = "";
        if (!answer(coach, theirs, sizeof TOKEN - 1, patience_s, "starting"))
            return false;
        if (strcmp(theirs, TOKEN) != 0) {
            child_stop(&coach->child, PATIENCE_S, NULL, 0);
            coach->state = BROKEN;
            return fail(coach, "the railslide that this FMU found has other variables: export the FMU anew from it");
        }
        coach->greeted = true;
    }
    coach->start_s = start_s;
    if (!ask(coach, START, start_s, coach->values + SET, sizeof coach->values - SET * sizeof(double), patience_s,
             "building the coach"))
        return false;
    coach->state = INITIALIZING;
    return true;
}

bool coach_begin(Coach *coach)
{
    if (!is_in(coach, INITIALIZING, "ExitInitializationMode"))
        return false;
    coach->state = STEPPING;
    return true;
}

double coach_now_s(const Coach *coach)
{
    return coach->start_s + TICK_S * (double)coach->ticks;
}

bool coach_step(Coach *coach, double from_s, double size_s)
{
    if (!is_in(coach, STEPPING, "DoStep"))
        return false;
    const double ticks = round(size_s / TICK_S);
    if (!(ticks >= 1.0 && fabs(size_s - ticks * TICK_S) < 1e-6))
        return fail(coach, "communicationStepSize = %.9g s: must be a whole multiple of %g s", size_s, TICK_S);
    if (!(fabs(from_s - coach_now_s(coach)) < 0.1 * TICK_S))
        return fail(coach, "currentCommunicationPoint = %.9g s: the coach is at %.9g s", from_s, coach_now_s(coach));
    if (!ask(coach, STEP, ticks, coach->values + SET, sizeof coach->values - SET * sizeof(double),
             limit_s(STEP_LIMIT_S + size_s), "computing a step"))
        return false;
    coach->ticks += (int64_t)ticks;
    return true;
}

bool coach_terminate(Coach *coach)
{
    if (coach->state == BROKEN)
        return fail(coach, "Terminate: the coach's Python process is gone");
    coach->state = TERMINATED;
    return true;
}

bool coach_reset(Coach *coach)
{
    const bool running = coach->state == INITIALIZING || coach->state == STEPPING || coach->state == TERMINATED;
    if (coach->greeted && running && !ask(coach, STOP, 0.0, NULL, 0, limit_s(STEP_LIMIT_S), "ending a run"))
        coach->state = BROKEN;
    if (coach->state == BROKEN) {
        child_stop(&coach->child, PATIENCE_S, NULL, 0);
        if (!start_child(coach))
            return false;
    }
    set_starts(coach);
    return true;
}

static bool is_there(const Coach *coach, char kind, uint32_t reference)
{
    return (reference < VALUES && KINDS[reference] == kind)
        || fail(coach, "value reference %u: no variable of the type that was asked for", (unsigned)reference);
}

const double *coach_get(const Coach *coach, char kind, uint32_t reference)
{
    return is_there(coach, kind, reference) ? &coach->values[reference] : NULL;
}

bool coach_set(Coach *coach, char kind, uint32_t reference, double value)
{
    if (!is_there(coach, kind, reference))
        return false;
    if (reference >= SET)
        return fail(coach, "value reference %u: an output cannot be set", (unsigned)reference);
    if (reference < PARAMETERS && coach->state != INSTANTIATED && coach->state != INITIALIZING)
        return fail(coach, "value reference %u: a fixed parameter is set before the first step", (unsigned)reference);
    coach->values[reference] = value;
    return true;
}

bool coach_lacks(const Coach *coach, const char *function)
{
    return fail(coach, "%s: not supported", function);
}
