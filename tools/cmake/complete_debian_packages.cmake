# What Debian wants of a package beside what is installed: a changelog and the licences in usr/share/doc/PACKAGE, compressed manual
# pages, and the reasons why lintian is overridden (tools/release.d/PACKAGE.lintian-overrides). CPack runs it between
# installation and packing. The date is SOURCE_DATE_EPOCH.

string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(tree ${CPACK_TEMPORARY_DIRECTORY}/${component}${CPACK_PACKAGING_INSTALL_PREFIX})
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(documents ${tree}/share/doc/${package})
  file(COPY ${CPACK_PROLEG_COPYRIGHT} DESTINATION ${documents})
  file(WRITE ${documents}/changelog "proleg (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}. /usr/share/doc/proleg/CHANGELOG.md says what changed.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
  set(overrides ${CPACK_PROLEG_OVERRIDES}/${package}.lintian-overrides)
  if(EXISTS ${overrides})
    file(MAKE_DIRECTORY ${tree}/share/lintian/overrides)
    file(COPY_FILE ${overrides} ${tree}/share/lintian/overrides/${package})
  endif()
  file(GLOB pages ${tree}/share/man/man*/*)
  execute_process(COMMAND gzip -9nf ${documents}/changelog ${pages} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND chmod -R u=rwX,go=rX ${CPACK_TEMPORARY_DIRECTORY}/${component} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
