# corda_embed(<target> <name> <namespace> <files>): turns text files into string constants of the generated header <name>, so
# that the program needs no other file at run time: capsule.vert -> <namespace>::kCapsuleVert.
set(CORDA_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_texts.cmake)

function(corda_embed target name namespace)
    set(output_dir ${PROJECT_BINARY_DIR}/generated/${target})
    set(output ${output_dir}/${name}.hpp)
    add_custom_command(OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DNAMESPACE=${namespace} "-DTEXTS=${ARGN}" -P ${CORDA_EMBED_SCRIPT}
        DEPENDS ${ARGN} ${CORDA_EMBED_SCRIPT} VERBATIM)
    target_sources(${target} PRIVATE ${output})
    target_include_directories(${target} PRIVATE ${output_dir})
endfunction()
