/* The functions of FMI 3.0; the standard's own headers check their forms. */
#include "fmi3Functions.h"

#include <string.h>

#include "coach.h"

#define UNUSED(name) (void)(name)

static fmi3Status status_of(bool fine)
{
    return fine ? fmi3OK : fmi3Error;
}

static void log_text(const Coach *coach, const char *text)
{
    fmi3LogMessageCallback logger = (fmi3LogMessageCallback)coach->logger;
    if (logger)
        logger(coach->environment, fmi3Error, LOG_CATEGORY, text);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance i, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    UNUSED(i), UNUSED(on), UNUSED(n), UNUSED(categories); /* there is nothing to log but errors */
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference required[], size_t n_required,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update)
{
    UNUSED(visible), UNUSED(logging), UNUSED(early_return), UNUSED(required), UNUSED(n_required), UNUSED(update);
    const Coach like = {
        .name = (char *)name,
        .resources = (char *)resources,
        .log = log_text,
        .logger = (void (*)(void))logger,
        .environment = environment,
    };
    if (event_mode) {
        coach_lacks(&like, "event mode");
        return NULL;
    }
    return coach_new(&like, token);
}

void fmi3FreeInstance(fmi3Instance i)
{
    coach_free(i);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start_s, fmi3Boolean has_stop, fmi3Float64 stop_s)
{
    UNUSED(has_tolerance), UNUSED(tolerance), UNUSED(has_stop), UNUSED(stop_s);
    return status_of(coach_initialize(i, start_s));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance i)
{
    return status_of(coach_begin(i));
}

fmi3Status fmi3Terminate(fmi3Instance i)
{
    return status_of(coach_terminate(i));
}

fmi3Status fmi3Reset(fmi3Instance i)
{
    return status_of(coach_reset(i));
}

#define GET_AND_SET(Name, kind)                                                                              \
    fmi3Status fmi3Get##Name(fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3##Name values[],   \
                             size_t n_values)                                                                \
    {                                                                                                        \
        for (size_t k = 0; k < n && k < n_values; k++) {                                                     \
            const double *found = coach_get(i, kind, vr[k]);                                                 \
            if (!found)                                                                                      \
                return fmi3Error;                                                                            \
            values[k] = (fmi3##Name)*found;                                                                  \
        }                                                                                                    \
        return fmi3OK;                                                                                       \
    }                                                                                                        \
    fmi3Status fmi3Set##Name(fmi3Instance i, const fmi3ValueReference vr[], size_t n,                        \
                             const fmi3##Name values[], size_t n_values)                                     \
    {                                                                                                        \
        for (size_t k = 0; k < n && k < n_values; k++)                                                       \
            if (!coach_set(i, kind, vr[k], (double)values[k]))                                               \
                return fmi3Error;                                                                            \
        return fmi3OK;                                                                                       \
    }

GET_AND_SET(Float64, 'r')
GET_AND_SET(Int32, 'i')
GET_AND_SET(Boolean, 'b')

fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 from_s, fmi3Float64 size_s, fmi3Boolean no_return,
                      fmi3Boolean *event_handling_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                      fmi3Float64 *last_successful_s)
{
    UNUSED(no_return);
    bool fine = coach_step(i, from_s, size_s);
    *event_handling_needed = *terminate = *early_return = fmi3False;
    *last_successful_s = coach_now_s(i);
    return status_of(fine);
}

/* What the model description says that it cannot do. Hosts want the symbols all the same. */
#define LACKS(function, ...)                             \
    fmi3Status function(fmi3Instance i, __VA_ARGS__)     \
    {                                                    \
        return status_of(coach_lacks(i, #function));     \
    }
#define LACKS_ALL(function)                              \
    fmi3Status function(fmi3Instance i)                  \
    {                                                    \
        return status_of(coach_lacks(i, #function));     \
    }
#define REFERENCES const fmi3ValueReference vr[], size_t n
#define LACKS_TYPE(Name)                                                              \
    LACKS(fmi3Get##Name, REFERENCES, fmi3##Name values[], size_t n_values)            \
    LACKS(fmi3Set##Name, REFERENCES, const fmi3##Name values[], size_t n_values)

#pragma clang diagnostic ignored "-Wunused-parameter"

LACKS_TYPE(Float32)
LACKS_TYPE(Int8)
LACKS_TYPE(UInt8)
LACKS_TYPE(Int16)
LACKS_TYPE(UInt16)
LACKS_TYPE(UInt32)
LACKS_TYPE(Int64)
LACKS_TYPE(UInt64)
LACKS_TYPE(String)
LACKS(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t n_values)
LACKS(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t n_values)
LACKS(fmi3GetClock, REFERENCES, fmi3Clock values[])
LACKS(fmi3SetClock, REFERENCES, const fmi3Clock values[])

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger)
{
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    return NULL;
}

LACKS_ALL(fmi3EnterEventMode)
LACKS_ALL(fmi3EnterStepMode)
LACKS_ALL(fmi3EnterConfigurationMode)
LACKS_ALL(fmi3ExitConfigurationMode)
LACKS_ALL(fmi3EnterContinuousTimeMode)
LACKS_ALL(fmi3EvaluateDiscreteStates)
LACKS(fmi3GetNumberOfVariableDependencies, fmi3ValueReference vr, size_t *n)
LACKS(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[],
      size_t independent_elements[], fmi3DependencyKind kinds[], size_t n)
LACKS(fmi3GetFMUState, fmi3FMUState *state)
LACKS(fmi3SetFMUState, fmi3FMUState state)
LACKS(fmi3FreeFMUState, fmi3FMUState *state)
LACKS(fmi3SerializedFMUStateSize, fmi3FMUState state, size_t *size)
LACKS(fmi3SerializeFMUState, fmi3FMUState state, fmi3Byte bytes[], size_t size)
LACKS(fmi3DeserializeFMUState, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
LACKS(fmi3GetDirectionalDerivative, const fmi3ValueReference unknowns[], size_t n_unknowns,
      const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[], size_t n_seed,
      fmi3Float64 sensitivity[], size_t n_sensitivity)
LACKS(fmi3GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t n_unknowns,
      const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[], size_t n_seed,
      fmi3Float64 sensitivity[], size_t n_sensitivity)
LACKS(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
LACKS(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
      fmi3IntervalQualifier qualifiers[])
LACKS(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
LACKS(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
LACKS(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
LACKS(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
LACKS(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
LACKS(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
LACKS(fmi3UpdateDiscreteStates, fmi3Boolean *need_update, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
      fmi3Boolean *values_changed, fmi3Boolean *next_event_defined, fmi3Float64 *next_event_s)
LACKS(fmi3CompletedIntegratorStep, fmi3Boolean no_return, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
LACKS(fmi3SetTime, fmi3Float64 t_s)
LACKS(fmi3SetContinuousStates, const fmi3Float64 x[], size_t n)
LACKS(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t n)
LACKS(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t n)
LACKS(fmi3GetContinuousStates, fmi3Float64 x[], size_t n)
LACKS(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t n)
LACKS(fmi3GetNumberOfEventIndicators, size_t *n)
LACKS(fmi3GetNumberOfContinuousStates, size_t *n)
LACKS(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t n_values)
LACKS(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 t_s)
