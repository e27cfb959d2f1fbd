# SPDX-License-Identifier: Apache-2.0
"""Everything is said in pyproject.toml but the wheel's tag: any Python 3, one platform, since the
package contains the shared library and no extension module."""

from setuptools import Distribution, setup
from wheel.bdist_wheel import bdist_wheel


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


class PlatformWheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


setup(distclass=BinaryDistribution, cmdclass={"bdist_wheel": PlatformWheel})
