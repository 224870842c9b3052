/* Functions that an FMI 2.0 co-simulation FMU must export and this one does not offer, as modelDescription.xml says.
 * Each returns fmi2Error whatever its arguments; fmi2Functions.h, which declares them, is left out on purpose. */
#if defined(_WIN32)
#define REFUSED(name) __declspec(dllexport) int name(void) { return 3; }
#else
#define REFUSED(name) __attribute__((visibility("default"))) int name(void) { return 3; }
#endif

REFUSED(fmi2GetString) REFUSED(fmi2SetString) REFUSED(fmi2GetFMUstate)
REFUSED(fmi2SetFMUstate) REFUSED(fmi2FreeFMUstate) REFUSED(fmi2SerializedFMUstateSize) REFUSED(fmi2SerializeFMUstate)
REFUSED(fmi2DeSerializeFMUstate) REFUSED(fmi2GetDirectionalDerivative) REFUSED(fmi2SetRealInputDerivatives)
REFUSED(fmi2GetRealOutputDerivatives) REFUSED(fmi2CancelStep) REFUSED(fmi2GetStatus) REFUSED(fmi2GetRealStatus)
REFUSED(fmi2GetIntegerStatus) REFUSED(fmi2GetBooleanStatus) REFUSED(fmi2GetStringStatus)
