/* An FMI 2.0 co-simulation FMU around a controller of railslide_controller.h: scalars `valve[1]` .. `valve[4]`. */
#include "fmi2Functions.h"
#include "fmu.h"

static fmi2Status failed(fmu *f) {
    if (f->log)
        ((fmi2CallbackLogger)f->log)(f->environment, "controller", fmi2Error, "logStatusError", "%s", f->message);
    return fmi2Error;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    if (type != fmi2CoSimulation || strcmp(guid, TOKEN) != 0)
        return NULL;
    fmu *f = make();
    if (f && functions) {
        f->environment = functions->componentEnvironment;
        f->log = (void (*)(void))functions->logger;
    }
    return f;
}

void fmi2FreeInstance(fmi2Component c) {
    if (c) {
        forget(c);
        free(c);
    }
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_s,
                               fmi2Boolean stop_defined, fmi2Real stop_s) {
    ((fmu *)c)->start_s = start_s;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return start(c) ? failed(c) : fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2Reset(fmi2Component c) {
    forget(c);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real at_s, fmi2Real period_s, fmi2Boolean no_return) {
    return step(c, at_s, period_s) ? failed(c) : fmi2OK;
}

#define ACCESS(Type, type, place)                                                                                     \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[]) {                \
        for (size_t i = 0; i < n; i++) {                                                                              \
            if (place(c, vr[i]) == NULL)                                                                              \
                return fmi2Error;                                                                                     \
            value[i] = *place(c, vr[i]);                                                                              \
        }                                                                                                             \
        return fmi2OK;                                                                                                \
    }                                                                                                                 \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t n, const type value[]) {          \
        for (size_t i = 0; i < n; i++) {                                                                              \
            if (place(c, vr[i]) == NULL)                                                                              \
                return fmi2Error;                                                                                     \
            *place(c, vr[i]) = value[i];                                                                              \
        }                                                                                                             \
        return fmi2OK;                                                                                                \
    }
ACCESS(Real, fmi2Real, real_at)
ACCESS(Integer, fmi2Integer, whole_at)
ACCESS(Boolean, fmi2Boolean, whole_at)
