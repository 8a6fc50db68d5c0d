/// A library for LD_PRELOAD in whose place an OpenCL call fails: FAILING_CALL names it,
/// FAILING_AFTER says how many calls succeed before.

#include <CL/cl.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>

namespace {

bool fails(const char *name) {
    static std::atomic<int> calls{0};
    const char *failing = std::getenv("FAILING_CALL");
    if (failing == nullptr || std::strcmp(failing, name) != 0)
        return false;
    const char *after = std::getenv("FAILING_AFTER");
    return calls++ >= (after != nullptr ? std::atoi(after) : 0);
}

template <typename Function> Function real(const char *name, Function) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" {

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t *offset, const size_t *global, const size_t *local,
                              cl_uint count, const cl_event *list, cl_event *event) {
    if (fails("clEnqueueNDRangeKernel"))
        return CL_OUT_OF_RESOURCES;
    return real("clEnqueueNDRangeKernel", &clEnqueueNDRangeKernel)(
        queue, kernel, dimensions, offset, global, local, count, list, event);
}

cl_int clWaitForEvents(cl_uint count, const cl_event *list) {
    if (fails("clWaitForEvents"))
        return CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST;
    return real("clWaitForEvents", &clWaitForEvents)(count, list);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void *host,
                      cl_int *error) {
    if (fails("clCreateBuffer")) {
        if (error != nullptr)
            *error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return nullptr;
    }
    return real("clCreateBuffer", &clCreateBuffer)(context, flags, size, host, error);
}

cl_context clCreateContext(const cl_context_properties *properties, cl_uint count,
                           const cl_device_id *devices,
                           void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *),
                           void *data, cl_int *error) {
    if (fails("clCreateContext")) {
        if (error != nullptr)
            *error = CL_DEVICE_NOT_AVAILABLE;
        return nullptr;
    }
    return real("clCreateContext", &clCreateContext)(properties, count, devices, notify, data,
                                                     error);
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices,
                      const char *options, void(CL_CALLBACK *notify)(cl_program, void *),
                      void *data) {
    if (fails("clBuildProgram"))
        return CL_BUILD_PROGRAM_FAILURE;
    return real("clBuildProgram", &clBuildProgram)(program, count, devices, options, notify, data);
}

} // extern "C"
