"""The page of a running system, which the page itself or a server runs."""

from shipcosim.report.live.export import export_page, live_page, prepared, server_page

__all__ = ["export_page", "live_page", "prepared", "server_page"]
