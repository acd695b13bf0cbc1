# precompile_headers(GROUP TARGET HEADER...): the first target of a group precompiles the headers (of other projects
# only), the others use what it made. A group is of one kind, libraries or executables, and of one set of options.
function(precompile_headers group target)
  get_property(owner GLOBAL PROPERTY precompiling_${group})
  if(owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY precompiling_${group} ${target})
  endif()
endfunction()
