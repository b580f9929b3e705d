// validate_gltf.cjs PACKAGE FILE: runs the Khronos glTF validator over a file; prints what it found and exits with 1 if
// that is any error or warning.
const fs = require('fs');
const validator = require(process.argv[2]);

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[3])), {maxIssues: 20}).then((report) => {
    const issues = report.issues;
    for (const message of issues.messages.filter((message) => message.severity < 2))
        console.log(`# ${message.code} ${message.pointer || ''} ${message.message}`);
    console.log(`# ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos`);
    process.exit(issues.numErrors + issues.numWarnings > 0 ? 1 : 0);
}).catch((error) => {
    console.log(`# ${error}`);
    process.exit(1);
});
