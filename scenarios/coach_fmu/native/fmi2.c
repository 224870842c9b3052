/* The functions of FMI 2.0; the standard's own headers check their forms. */
#include "fmi2Functions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "coach.h"

#define UNUSED(name) (void)(name)

static fmi2Status status_of(bool fine)
{
    return fine ? fmi2OK : fmi2Error;
}

/* The host takes the message for a format: what is in it must not be one. */
static void log_text(const Coach *coach, const char *text)
{
    char doubled[2400];
    size_t n = 0;
    for (; *text && n + 2 < sizeof doubled; text++) {
        doubled[n++] = *text;
        if (*text == '%')
            doubled[n++] = '%';
    }
    doubled[n] = '\0';
    fmi2CallbackLogger logger = (fmi2CallbackLogger)coach->logger;
    if (logger)
        logger(coach->environment, coach->name, fmi2Error, LOG_CATEGORY, doubled);
}

static int hexadecimal(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if ((c | 32) >= 'a' && (c | 32) <= 'f')
        return (c | 32) - 'a' + 10;
    return -1;
}

/* Path of a file URI (file:/a, file:///a, file://localhost/a) without a closing slash, NULL if it is none; to free. */
static char *path_of(const char *uri)
{
    if (!uri || strncmp(uri, "file:", 5) != 0)
        return NULL;
    const char *path = uri + 5;
    if (strncmp(path, "//", 2) == 0)
        path = strchr(path + 2, '/');
    if (!path || *path != '/')
        return NULL;
    char *plain = malloc(strlen(path) + 1);
    size_t n = 0;
    for (; plain && *path; path++) {
        int high = *path == '%' ? hexadecimal(path[1]) : -1;
        int low = high >= 0 ? hexadecimal(path[2]) : -1;
        plain[n++] = low >= 0 ? (char)(16 * high + low) : *path;
        path += low >= 0 ? 2 : 0;
    }
    while (n > 1 && plain[n - 1] == '/')
        n--;
    if (plain)
        plain[n] = '\0';
    return plain;
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(categories); /* there is nothing to log but errors */
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    UNUSED(visible), UNUSED(logging);
    char *folder = path_of(resources);
    const Coach like = {
        .name = (char *)(name ? name : ""),
        .resources = folder,
        .log = log_text,
        .logger = functions ? (void (*)(void))functions->logger : NULL,
        .environment = functions ? functions->componentEnvironment : NULL,
    };
    Coach *coach = NULL;
    if (type == fmi2CoSimulation)
        coach = coach_new(&like, guid);
    else
        coach_lacks(&like, "model exchange");
    free(folder);
    return coach;
}

void fmi2FreeInstance(fmi2Component c)
{
    coach_free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start_s,
                               fmi2Boolean has_stop, fmi2Real stop_s)
{
    UNUSED(has_tolerance), UNUSED(tolerance), UNUSED(has_stop), UNUSED(stop_s);
    Coach *coach = c;
    coach->start_s = start_s;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Coach *coach = c;
    return status_of(coach_initialize(coach, coach->start_s));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return status_of(coach_begin(c));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return status_of(coach_terminate(c));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return status_of(coach_reset(c));
}

#define GET_AND_SET(Name, Type, kind)                                                                          \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, Type value[])           \
    {                                                                                                          \
        for (size_t k = 0; k < n; k++) {                                                                       \
            const double *found = coach_get(c, kind, vr[k]);                                                   \
            if (!found)                                                                                        \
                return fmi2Error;                                                                              \
            value[k] = (Type)*found;                                                                           \
        }                                                                                                      \
        return fmi2OK;                                                                                         \
    }                                                                                                          \
    fmi2Status fmi2Set##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, const Type value[])     \
    {                                                                                                          \
        for (size_t k = 0; k < n; k++)                                                                         \
            if (!coach_set(c, kind, vr[k], (double)value[k]))                                                  \
                return fmi2Error;                                                                              \
        return fmi2OK;                                                                                         \
    }

GET_AND_SET(Real, fmi2Real, 'r')
GET_AND_SET(Integer, fmi2Integer, 'i')
GET_AND_SET(Boolean, fmi2Boolean, 'b')

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
{
    UNUSED(vr), UNUSED(value);
    return status_of(n == 0 || coach_lacks(c, "fmi2GetString"));
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
{
    UNUSED(vr), UNUSED(value);
    return status_of(n == 0 || coach_lacks(c, "fmi2SetString"));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from_s, fmi2Real size_s, fmi2Boolean no_return)
{
    UNUSED(no_return);
    return status_of(coach_step(c, from_s, size_s));
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = coach_now_s(c);
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    UNUSED(c);
    if (kind != fmi2Terminated)
        return fmi2Discard;
    *value = fmi2False;
    return fmi2OK;
}

/* Steps are done when fmi2DoStep returns: nothing is ever pending. */
#define NO_STATUS(Name, Type)                                                            \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2StatusKind kind, Type *value)    \
    {                                                                                    \
        UNUSED(c), UNUSED(kind), UNUSED(value);                                          \
        return fmi2Discard;                                                              \
    }

NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(StringStatus, fmi2String)

/* What the model description says that it cannot do. Hosts want the symbols all the same. */
#define LACKS(function, ...)                              \
    fmi2Status function(fmi2Component c, __VA_ARGS__)     \
    {                                                     \
        return status_of(coach_lacks(c, #function));      \
    }
#define LACKS_ALL(function)                               \
    fmi2Status function(fmi2Component c)                  \
    {                                                     \
        return status_of(coach_lacks(c, #function));      \
    }

#pragma clang diagnostic ignored "-Wunused-parameter"

LACKS_ALL(fmi2CancelStep)
LACKS_ALL(fmi2EnterEventMode)
LACKS_ALL(fmi2EnterContinuousTimeMode)
LACKS(fmi2GetFMUstate, fmi2FMUstate *state)
LACKS(fmi2SetFMUstate, fmi2FMUstate state)
LACKS(fmi2FreeFMUstate, fmi2FMUstate *state)
LACKS(fmi2SerializedFMUstateSize, fmi2FMUstate state, size_t *size)
LACKS(fmi2SerializeFMUstate, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
LACKS(fmi2DeSerializeFMUstate, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
LACKS(fmi2GetDirectionalDerivative, const fmi2ValueReference z[], size_t nz, const fmi2ValueReference v[], size_t nv,
      const fmi2Real dv[], fmi2Real dz[])
LACKS(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
      const fmi2Real value[])
LACKS(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
      fmi2Real value[])
LACKS(fmi2NewDiscreteStates, fmi2EventInfo *info)
LACKS(fmi2CompletedIntegratorStep, fmi2Boolean no_return, fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
LACKS(fmi2SetTime, fmi2Real t_s)
LACKS(fmi2SetContinuousStates, const fmi2Real x[], size_t n)
LACKS(fmi2GetDerivatives, fmi2Real derivatives[], size_t n)
LACKS(fmi2GetEventIndicators, fmi2Real indicators[], size_t n)
LACKS(fmi2GetContinuousStates, fmi2Real x[], size_t n)
LACKS(fmi2GetNominalsOfContinuousStates, fmi2Real x[], size_t n)
