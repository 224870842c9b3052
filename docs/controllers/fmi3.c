/* An FMI 3.0 co-simulation FMU around a controller of railslide_controller.h: arrays such as `valve` of four. */
#include "fmi3Functions.h"
#include "fmu.h"

static fmi3Status failed(fmu *f) {
    if (f->log)
        ((fmi3LogMessageCallback)f->log)(f->environment, fmi3Error, "logStatusError", f->message);
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    return fmi3OK;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t intermediates,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    if (event_mode || strcmp(token, TOKEN) != 0)
        return NULL;
    fmu *f = make();
    if (f) {
        f->environment = environment;
        f->log = (void (*)(void))log;
    }
    return f;
}

void fmi3FreeInstance(fmi3Instance c) {
    if (c) {
        forget(c);
        free(c);
    }
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start_s, fmi3Boolean stop_defined, fmi3Float64 stop_s) {
    ((fmu *)c)->start_s = start_s;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return start(c) ? failed(c) : fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

fmi3Status fmi3Reset(fmi3Instance c) {
    forget(c);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 at_s, fmi3Float64 period_s, fmi3Boolean no_return,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last_s) {
    *event = *terminate = *early = 0;
    *last_s = at_s + period_s;
    return step(c, at_s, period_s) ? failed(c) : fmi3OK;
}

static size_t length(unsigned reference) {
    return reference == AXLE_SPEED || reference == VALID || reference == VALVE || reference == SAND ? 4 : 1;
}

#define ACCESS(Type, type, place)                                                                                     \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type value[], size_t values) {  \
        for (size_t i = 0, at = 0; i < n; i++)                                                                        \
            for (size_t k = 0; k < length(vr[i]); k++, at++) {                                                        \
                if (at >= values || place(c, vr[i]) == NULL)                                                          \
                    return fmi3Error;                                                                                 \
                value[at] = place(c, vr[i])[k];                                                                       \
            }                                                                                                         \
        return fmi3OK;                                                                                                \
    }                                                                                                                 \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const type value[],             \
                             size_t values) {                                                                         \
        for (size_t i = 0, at = 0; i < n; i++)                                                                        \
            for (size_t k = 0; k < length(vr[i]); k++, at++) {                                                        \
                if (at >= values || place(c, vr[i]) == NULL)                                                          \
                    return fmi3Error;                                                                                 \
                place(c, vr[i])[k] = value[at];                                                                       \
            }                                                                                                         \
        return fmi3OK;                                                                                                \
    }
ACCESS(Float64, fmi3Float64, real_at)
ACCESS(Int32, fmi3Int32, whole_at)
ACCESS(Boolean, fmi3Boolean, whole_at)
