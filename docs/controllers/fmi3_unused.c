/* Functions that an FMI 3.0 co-simulation FMU must export and this one does not offer, as modelDescription.xml says.
 * Each returns fmi3Error whatever its arguments; fmi3Functions.h, which declares them, is left out on purpose. */
#if defined(_WIN32)
#define REFUSED(name) __declspec(dllexport) int name(void) { return 3; }
#else
#define REFUSED(name) __attribute__((visibility("default"))) int name(void) { return 3; }
#endif

REFUSED(fmi3EnterEventMode) REFUSED(fmi3GetFloat32) REFUSED(fmi3GetInt8) REFUSED(fmi3GetUInt8) REFUSED(fmi3GetInt16)
REFUSED(fmi3GetUInt16) REFUSED(fmi3GetUInt32) REFUSED(fmi3GetInt64) REFUSED(fmi3GetUInt64) REFUSED(fmi3GetString)
REFUSED(fmi3GetBinary) REFUSED(fmi3GetClock) REFUSED(fmi3SetFloat32) REFUSED(fmi3SetInt8) REFUSED(fmi3SetUInt8)
REFUSED(fmi3SetInt16) REFUSED(fmi3SetUInt16) REFUSED(fmi3SetUInt32) REFUSED(fmi3SetInt64) REFUSED(fmi3SetUInt64)
REFUSED(fmi3SetString) REFUSED(fmi3SetBinary) REFUSED(fmi3SetClock) REFUSED(fmi3GetNumberOfVariableDependencies)
REFUSED(fmi3GetVariableDependencies) REFUSED(fmi3GetFMUState) REFUSED(fmi3SetFMUState) REFUSED(fmi3FreeFMUState)
REFUSED(fmi3SerializedFMUStateSize) REFUSED(fmi3SerializeFMUState) REFUSED(fmi3DeserializeFMUState)
REFUSED(fmi3GetDirectionalDerivative) REFUSED(fmi3GetAdjointDerivative) REFUSED(fmi3EnterConfigurationMode)
REFUSED(fmi3ExitConfigurationMode) REFUSED(fmi3GetIntervalDecimal) REFUSED(fmi3GetIntervalFraction)
REFUSED(fmi3GetShiftDecimal) REFUSED(fmi3GetShiftFraction) REFUSED(fmi3SetIntervalDecimal)
REFUSED(fmi3SetIntervalFraction) REFUSED(fmi3SetShiftDecimal) REFUSED(fmi3SetShiftFraction)
REFUSED(fmi3EvaluateDiscreteStates) REFUSED(fmi3UpdateDiscreteStates) REFUSED(fmi3EnterContinuousTimeMode)
REFUSED(fmi3CompletedIntegratorStep) REFUSED(fmi3SetTime) REFUSED(fmi3SetContinuousStates)
REFUSED(fmi3GetContinuousStateDerivatives) REFUSED(fmi3GetEventIndicators) REFUSED(fmi3GetContinuousStates)
REFUSED(fmi3GetNominalsOfContinuousStates) REFUSED(fmi3GetNumberOfEventIndicators)
REFUSED(fmi3GetNumberOfContinuousStates) REFUSED(fmi3EnterStepMode) REFUSED(fmi3GetOutputDerivatives)
REFUSED(fmi3ActivateModelPartition)
