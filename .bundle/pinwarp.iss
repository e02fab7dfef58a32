; The installer for Windows, made by Inno Setup 6: make.py calls it with /DVersion=...
; Installs for the user alone, without an administrator, unless one asks for more.
[Setup]
AppId={{6E0C7B53-7E0B-4C43-9C7F-0D6C8B3A51F2}
AppName=pinwarp
AppVersion={#Version}
AppPublisher=The pinwarp developers
DefaultDirName={autopf}\pinwarp
DefaultGroupName=pinwarp
DisableProgramGroupPage=yes
LicenseFile=..\LICENSE
OutputDir=..\dist
SetupIconFile=..\build\icons\pinwarp.ico
UninstallDisplayIcon={app}\pinwarp.exe
ArchitecturesAllowed=x64compatible
ArchitecturesInstallIn64BitMode=x64compatible
PrivilegesRequired=lowest
PrivilegesRequiredOverridesAllowed=dialog
ChangesAssociations=yes
Compression=lzma2
SolidCompression=yes
WizardStyle=modern

[InstallDelete]
; What an older version brought and this one does not.
Type: filesandordirs; Name: "{app}\_internal"

[Files]
Source: "..\dist\pinwarp\*"; DestDir: "{app}"; Flags: recursesubdirs ignoreversion

[Tasks]
Name: desktopicon; Description: "Put an icon on the desktop"; Flags: unchecked

[Icons]
Name: "{group}\pinwarp"; Filename: "{app}\pinwarp.exe"
Name: "{autodesktop}\pinwarp"; Filename: "{app}\pinwarp.exe"; Tasks: desktopicon

[Registry]
; Windows knows a file by what is behind its last dot only, and .csv is a spreadsheet's: what is
; called *.pinwarp.csv has "Open in pinwarp" in its own menu instead.
Root: HKA; Subkey: "Software\Classes\SystemFileAssociations\.csv\shell\pinwarp"; ValueType: string; ValueData: "Open in pinwarp"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\SystemFileAssociations\.csv\shell\pinwarp"; ValueType: string; ValueName: "AppliesTo"; ValueData: "System.FileName:~>"".pinwarp.csv"" OR System.FileName:~>"".pinwarp-model.csv"""
Root: HKA; Subkey: "Software\Classes\SystemFileAssociations\.csv\shell\pinwarp"; ValueType: string; ValueName: "Icon"; ValueData: "{app}\pinwarp.exe"
Root: HKA; Subkey: "Software\Classes\SystemFileAssociations\.csv\shell\pinwarp\command"; ValueType: string; ValueData: """{app}\pinwarp.exe"" ""%1"""
Root: HKA; Subkey: "Software\Classes\Applications\pinwarp.exe\shell\open\command"; ValueType: string; ValueData: """{app}\pinwarp.exe"" ""%1"""; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\.osim\OpenWithProgids"; ValueType: string; ValueName: "pinwarp.model"; ValueData: ""; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\pinwarp.model"; ValueType: string; ValueData: "OpenSim model"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\pinwarp.model\shell\open\command"; ValueType: string; ValueData: """{app}\pinwarp.exe"" ""%1"""

[Run]
Filename: "{app}\pinwarp.exe"; Description: "Start pinwarp"; Flags: nowait postinstall skipifsilent
