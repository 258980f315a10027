# What is installed beside programs, and the Debian package made of it (scripts/package, docs/install.md).

# Manual pages are made from the help of the programs by the target man_pages, which takes help2man.
set(man_pages ${PROJECT_BINARY_DIR}/man)
add_custom_target(man_pages
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/man_pages ${PROJECT_BINARY_DIR} ${man_pages}
  DEPENDS orchestrator agent physics_server vehicle
  COMMENT "Making manual pages")
foreach(section 1 5)
  install(DIRECTORY ${man_pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section} OPTIONAL
    FILES_MATCHING PATTERN "*.${section}.gz")
endforeach()

install(FILES scripts/completion/orchestrator.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME orchestrator)
install(FILES scripts/completion/_orchestrator DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(DIRECTORY idl/mascot_msgs DESTINATION ${CMAKE_INSTALL_DATADIR})  # a package of ROS 2, as its source
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
  PATTERN build EXCLUDE PATTERN examples EXCLUDE PATTERN mascot.schema.json EXCLUDE)

# The documents name ../configs.
file(CREATE_LINK ../../mascot/configs ${PROJECT_BINARY_DIR}/link_to_configs SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/link_to_configs DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME configs)

math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
# Two packages: mascot, and python3-mascot (the component python), which is the module for Python.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified python)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME mascot)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mascot)
set(CPACK_PACKAGE_NAME mascot)
set(CPACK_PACKAGE_CONTACT "MASCOT developers <mascot@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "testbed for decentralised control of multi-agent systems")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A TOML file describes an experiment: the agents (quadrotors, unicycles, ideal
integrators), which agent hears which, and the control law. MASCOT flies it
with a Bullet physics server and one process per agent on Fast DDS, records
everything, and compares what it measures with what theory predicts.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Depends: what the programs link, the page's libraries, and NumPy for laws in Python and for pictures.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS "python3, python3-numpy, libjs-three, libjs-dygraphs")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_RECOMMENDS "python3-matplotlib, python3-optuna")  # pictures; tune
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "ffmpeg, bash-completion, cmake, g++, libeigen3-dev, octave, octave-instrument-control, python3-mascot")  # films; laws; matlab/
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "teams of MASCOT as environments for learning, in Python
 The module mascot: multi-drone environments in the forms of PettingZoo and
 Gymnasium, in which agents observe what they hear; laws as functions; arrays
 of recorded runs.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${next_minor}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "mascot (= ${PROJECT_VERSION}-1)")  # verify, view, plot
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-torch")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
include(CPack)
