"""The page that runs a system itself."""

from shipcosim.report.live.export import export_page, live_page

__all__ = ["export_page", "live_page"]
