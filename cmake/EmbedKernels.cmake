# embed_kernels(OUT DIR): sets OUT to a generated C++ file that holds every .cl, .clh, .h and .def
# file below DIR as text (host/device/kernel_sources.h declares the table).
function(embed_kernels out dir)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${dir}/*.cl ${dir}/*.clh ${dir}/*.h ${dir}/*.def)
  set(generated ${CMAKE_BINARY_DIR}/generated/kernel_sources.cpp)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DKERNEL_DIR=${dir} -DOUTPUT=${generated} -P
            ${CMAKE_SOURCE_DIR}/cmake/WriteKernelSources.cmake
    DEPENDS ${files} ${CMAKE_SOURCE_DIR}/cmake/WriteKernelSources.cmake
    COMMENT "Embedding the kernel sources")
  set(${out} ${generated} PARENT_SCOPE)
endfunction()
